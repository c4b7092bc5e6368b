// Motion blur of a sample file: the image that a shutter exposes while the recorded objects move.
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

/// How moving objects are blurred.
/// convolve: convolves the raster of the objects that share a path with the raster of the path.
/// lightfield: averages views of the surfaces at many instants.
/// automatic: convolve for objects that move parallel to the film (within 0.25 px) as a whole, and for those
/// with parallax that are one surface with nothing else in its range of depth; lightfield for all others.
enum class MotionMethod { automatic, convolve, lightfield };

struct MotionBlurSettings {
    Exposure exposure;  ///< on the scene's clock, open <= close
    ShutterCurve curve = ShutterCurve::box();
    MotionMethod method = MotionMethod::automatic;
    std::optional<int> views;       ///< number of views of lightfield
    std::vector<ObjectPath> paths;  ///< replace the file's motion of their ids
    std::optional<double> fit_px;   ///< tolerance within which splines replace paths
    /// Wanted part of the image; the other pixels are undefined. The wanted pixels have the same bits as
    /// without a crop, and shares refer to them. Only lightfield becomes faster.
    std::optional<Crop> crop;
};

struct MotionWarning {
    std::string code;  ///< "uncovered", "overscan", "left_out", "reflection", "shadow", "light"
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

/// Method that was chosen for an id, with the reason.
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

/// Makes the image of a sample file with motion blur. The result is bit-identical for any number of threads.
/// If nothing moves between the recorded instant and the exposure, it is the pinhole image, bit for bit.
/// Throws Error(wrong_arguments) for settings out of range, Error(invalid_input) for paths of unknown ids and
/// for a damaged file, Error(out_of_memory).
[[nodiscard]] MotionBlurResult motion_blur(const SampleFileReader& file, const MotionBlurSettings& settings);

}  // namespace postlens
