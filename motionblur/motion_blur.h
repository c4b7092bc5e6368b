// Motion blur of a sample file: computes the image that is exposed while the recorded objects move.
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
/// - convolve: convolves the image of the objects that share a path with the image of that path.
/// - lightfield: averages views of the surfaces at many instants.
/// - automatic: convolve for two kinds of objects, both moving parallel to the film. In the first kind, all
///   points move alike (within 0.25 px). In the second kind, nearer points move farther (parallax); the
///   object is a single surface, and no other surface lies in its range of depth. All other objects use
///   lightfield.
enum class MotionMethod { automatic, convolve, lightfield };

struct MotionBlurSettings {
    Exposure exposure;  ///< on the scene's clock, s; open <= close
    ShutterCurve curve = ShutterCurve::box();
    MotionMethod method = MotionMethod::automatic;
    std::optional<int> views;       ///< number of views of lightfield
    std::vector<ObjectPath> paths;  ///< each replaces the file's motion of the path's ids
    std::optional<double> fit_px;   ///< tolerance within which splines replace paths, px
    /// The part of the image to compute; all other pixels are undefined. The computed pixels are
    /// bit-identical to those without a crop, and the shares in the result refer to them. Only lightfield
    /// becomes faster with a crop.
    std::optional<Crop> crop;
};

struct MotionWarning {
    std::string code;  ///< "uncovered", "overscan", "left_out", "reflection", "shadow", "light"
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

/// The method that was chosen for an object id, and the reason.
struct ObjectReport {
    std::uint32_t id = 0;
    std::string name;
    MotionMethod method = MotionMethod::automatic;  ///< automatic: the id needs no method or has none
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0, deviation_px = 0;
    int slices = 0;                                 ///< number of depth slices of convolve
    std::size_t path_points = 0, fitted_knots = 0;  ///< of the path of convolve; 0 knots: not fitted
    double fit_error_px = 0;
    std::string reason;
};

struct MotionBlurResult {
    Image image;
    MotionMethod method = MotionMethod::automatic;  ///< automatic: both were used, or nothing moves
    int views = 0;                                  ///< number of views of lightfield; 0: not used
    double touched_share = 0;                       ///< share of the pixels over which an object moves
    std::vector<ObjectReport> objects;
    std::vector<MotionWarning> warnings;
};

/// Throws Error(wrong_arguments) unless both times are finite and open_s <= close_s.
void check_exposure(const Exposure& exposure);

/// Computes the image of a sample file with motion blur. The result is bit-identical for any number of
/// threads. If nothing moves between the recorded instant and the exposure, it is bit-identical to the
/// pinhole image. Throws Error(wrong_arguments) for settings out of range, Error(invalid_input) for paths of
/// unknown ids and for a damaged file, and Error(out_of_memory).
[[nodiscard]] MotionBlurResult motion_blur(const SampleFileReader& file, const MotionBlurSettings& settings);

}  // namespace postlens
