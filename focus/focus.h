// The focus processor. It computes the image that a lens would form, from a sample file.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "focus/frame.h"
#include "focus/light_field/lens_views.h"
#include "focus/responses/depth_levels.h"
#include "lens/focus_geometry.h"
#include "lens/impulse.h"
#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// The methods of computing an image. focus_picture implements all methods except `hybrid` (planner/hybrid.h)
/// and `automatic` (planner/auto_picture.h).
enum class FocusMethod { pinhole, scatter, layers, lightfield, hybrid, automatic };

struct FocusSettings {
    /// An infinite f_number means a pinhole. If `impulse` is a real lens, the focal length of that lens is
    /// used instead of `lens.focal_length_mm`.
    ThinLens lens;
    double focus_distance_m = 1;
    Framing framing = Framing::keep;
    FocusMethod method = FocusMethod::scatter;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    Impulse impulse;
    /// Number of depths that have an impulse response, from 2 to DepthLevels::most_depths. Each sample uses
    /// the response of the nearest depth. By default, the number is chosen so that this rounding changes CoC
    /// diameters up to 2048 px by less than half a pixel. If `spacing` is linear, it is at most
    /// most_linear_levels, and the change may be larger.
    std::optional<int> depths;
    /// Number of views of `lightfield`, 1 to most_lens_views.
    int views = default_lens_views;
    /// If present, only the pixels within this crop are computed, bit-identical to those of the whole image.
    /// All other pixels are undefined. Warnings count only the pixels within the crop.
    std::optional<Crop> crop;
    /// Memory limit, in bytes, for the splats (impulse responses of samples) of the methods `scatter` and
    /// `layers`. An image that may need more is made in strips (groups of rows), and the records are read
    /// again for each strip. The result is bit-identical.
    std::size_t splat_bytes = std::size_t{672} << 20;
    /// If `layers` would compute more than this many sums (layer_sums), the result has no image.
    double most_layer_sums = std::numeric_limits<double>::infinity();
};

struct FocusWarning {
    /// Identifies the kind of warning. For example, "overscan" means that light from beyond the recorded
    /// pixels reaches the image, and "uncovered" that the lens sees surfaces that are not recorded.
    std::string code;
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

struct FocusResult {
    Image image;
    FocusMethod method = FocusMethod::scatter;  ///< the method used; `pinhole` if the aperture is 0
    /// Number of impulse responses for different depths: FocusSettings::depths if given, otherwise the number
    /// of different CoC radii in use. It is 0 for a pinhole.
    int depths = 0;
    int views = 0;              ///< number of views of `lightfield`
    double largest_coc_px = 0;  ///< largest CoC diameter of a surface seen directly, px of the image
    /// Absent for an orthographic file.
    std::optional<FocusGeometry> geometry;
    std::vector<FocusWarning> warnings;
};

/// Computes the image that the lens forms. The result is bit-identical for any number of threads. Throws
/// Error(wrong_arguments) if a setting is out of range, if the crop exceeds the image, or if the file is
/// orthographic and the f-number is finite. Throws Error(invalid_input) if the file is damaged.
[[nodiscard]] FocusResult focus_picture(FocusFrame& frame, const FocusSettings& settings);
/// Computes one image directly from a file. Throws the same errors as the overload for a FocusFrame.
[[nodiscard]] FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings);

/// Computes the pinhole image by summing the records. The result is bit-identical to the flat image in part 0
/// of the file.
[[nodiscard]] Image pinhole_picture(const SampleFileReader& file,
                                    const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
