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
/// - convolve: convolves an image of the objects with a blur kernel, which is an image of their common motion
///   path.
/// - lightfield: averages views, which are images of the surfaces at many instants.
/// - automatic: uses convolve for objects that move parallel to the film, and lightfield for all others. If
///   near parts of an object move farther in the image than its distant parts (parallax), convolve is used
///   only if the object is a single surface, and no other surface lies within its range of depth.
enum class MotionMethod { automatic, convolve, lightfield };

struct MotionBlurSettings {
    Exposure exposure;  ///< in seconds on the scene's clock, with open <= close
    ShutterCurve curve = ShutterCurve::box();
    MotionMethod method = MotionMethod::automatic;
    std::optional<int> views;       ///< number of instants that method lightfield averages
    std::vector<ObjectPath> paths;  ///< replace the motion that the file states for these objects
    std::optional<double> fit_px;   ///< tolerance within which splines replace paths, px
    /// Part of the image that is computed; the whole image if absent. The computed pixels are bit-identical
    /// to those of the whole image. Pixels outside the crop are undefined, and they do not count in reported
    /// fractions of pixels.
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
    /// The motion path along which the method `convolve` moves the object's image: a sequence of
    /// `path_points` points, joined by straight lines. On request, a spline replaces it. `fitted_knots` is
    /// the spline's number of knots (0 without a spline), and `fit_error_px` is its largest distance from the
    /// points, in px.
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

/// Computes the motion-blurred image of a sample file. If nothing moves, the result is the image that the
/// file records. Results are bit-identical for any number of threads.
///
/// Throws Error(wrong_arguments) if a setting is out of range, Error(invalid_input) for damaged files or
/// unknown object ids, and Error(out_of_memory).
[[nodiscard]] MotionBlurResult motion_blur(const SampleFileReader& file, const MotionBlurSettings& settings);

}  // namespace postlens
