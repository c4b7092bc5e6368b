// The motion-blur processor: a sample file, the motion of what is in it and a shutter in, the picture that
// the shutter would take out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"
#include "motionblur/paths_file.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

/// convolve: i1 * i2 for every moving group. lightfield: the surfaces at many instants. automatic: convolve
/// for what moves parallel to the film (within 0.25 px), as a whole or, where it is one surface and nothing
/// else lies in its depth, each part by its own depth; lightfield for the rest.
enum class MotionMethod { automatic, convolve, lightfield };

struct MotionBlurSettings {
    Exposure exposure;  ///< on the scene's clock, open <= close
    ShutterCurve curve = ShutterCurve::box();
    MotionMethod method = MotionMethod::automatic;
    std::optional<int> views;       ///< of lightfield
    std::vector<ObjectPath> paths;  ///< in place of what the file says of these ids
    std::optional<double> fit_px;   ///< replace paths by splines within so much
    /// What of the picture is wanted; the rest of the image may be anything. These pixels have the same bits
    /// as without; shares are theirs. Only lightfield is the faster for it.
    std::optional<Crop> crop;
};

struct MotionWarning {
    std::string code;  ///< "uncovered", "overscan", "left_out", "reflection", "shadow", "light"
    double share = 0;  ///< of the pixels concerned
    std::string text;
};

/// What was done with an id, and why.
struct ObjectReport {
    std::uint32_t id = 0;
    std::string name;
    MotionMethod method = MotionMethod::automatic;  ///< automatic: none
    MotionKind kind = MotionKind::still;
    double largest_move_px = 0, deviation_px = 0;
    int slices = 0;                                 ///< of depth, convolve
    std::size_t path_points = 0, fitted_knots = 0;  ///< convolve; knots 0: not fitted
    double fit_error_px = 0;
    std::string reason;
};

struct MotionBlurResult {
    Image image;
    MotionMethod method = MotionMethod::automatic;  ///< automatic: both were used, or nothing moves
    int views = 0;                                  ///< of lightfield; 0: not used
    double touched_share = 0;  ///< of the pixels over which something moves; the others are the still picture
    std::vector<ObjectReport> objects;
    std::vector<MotionWarning> warnings;
};

/// Throws Error(wrong_arguments) unless both are finite and open is not after close.
void check_exposure(const Exposure& exposure);

/// Deterministic: the same bits for any number of threads. With nothing that moves between the records and
/// the exposure it is the pinhole picture, bit for bit. Throws Error(wrong_arguments) for settings out of
/// range, Error(invalid_input) for paths of unknown ids and for a damaged file, Error(out_of_memory).
[[nodiscard]] MotionBlurResult motion_blur(const SampleFileReader& file, const MotionBlurSettings& settings);

}  // namespace postlens
