// Computes the motion-blurred image of a sample file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"
#include "motionblur/paths/paths_file.h"
#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Method by which moving objects are blurred.
/// - convolve: convolves the objects' image with the image of their common path.
/// - lightfield: averages views of the surfaces at many instants.
/// - automatic: convolve for objects that move parallel to the film, and lightfield for all others. If near
///   parts of an object move farther than distant parts, convolve also needs a single surface, alone in its
///   range of depth.
enum class MotionMethod { automatic, convolve, lightfield };

struct MotionBlurSettings {
    Exposure exposure;  ///< in seconds on the scene's clock, with open <= close
    ShutterCurve curve = ShutterCurve::box();
    MotionMethod method = MotionMethod::automatic;
    std::optional<int> views;       ///< number of instants that method lightfield averages
    std::vector<ObjectPath> paths;  ///< replace the motion that the file states for these objects
    std::optional<double> fit_px;   ///< tolerance within which splines replace paths, px
    /// If set, only this part of the image is computed, and is bit-identical to this part of the whole image.
    /// Pixels outside are undefined, and do not count in reported fractions of pixels.
    std::optional<Crop> crop;
};

struct MotionWarning {
    std::string code;  ///< "uncovered", "overscan", "left_out", "reflection", "shadow", "light"
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

/// How one object was blurred: the method that was chosen, and the reason.
struct ObjectReport {
    std::uint32_t id = 0;
    std::string name;
    MotionMethod method = MotionMethod::automatic;  ///< `automatic` if the id needs no method or has none
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0, deviation_px = 0;
    int slices = 0;  ///< number of depth slices that method convolve blurs
    /// Method convolve moves the object along a path of `path_points` points. `fitted_knots` is the number of
    /// knots of the spline fitted to it (0 if none), and `fit_error_px` the error of this fit.
    std::size_t path_points = 0, fitted_knots = 0;
    double fit_error_px = 0;
    std::string reason;
};

struct MotionBlurResult {
    Image image;
    /// `automatic` if both methods were used, or if nothing moves.
    MotionMethod method = MotionMethod::automatic;
    int views = 0;             ///< number of instants that method lightfield averaged; 0 if it was not used
    double touched_share = 0;  ///< share of the pixels over which an object moves
    std::vector<ObjectReport> objects;
    std::vector<MotionWarning> warnings;
};

/// Throws Error(wrong_arguments) unless both times are finite and open_s <= close_s.
void check_exposure(const Exposure& exposure);

/// Computes the motion-blurred image of a sample file, bit-identical for any number of threads. If nothing
/// moves, it is the image that the file records.
///
/// Throws Error(wrong_arguments) for settings out of range, Error(invalid_input) for damaged files or unknown
/// object ids, and Error(out_of_memory).
[[nodiscard]] MotionBlurResult motion_blur(const SampleFileReader& file, const MotionBlurSettings& settings);

}  // namespace postlens
