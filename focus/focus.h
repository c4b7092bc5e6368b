// The focus processor: makes the image that a lens would take, from a sample file.
#pragma once

#include <cstdint>
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

/// The methods of making an image. focus_picture makes all but `hybrid` (planner/hybrid.h) and `automatic`
/// (planner/auto_picture.h).
enum class FocusMethod { pinhole, scatter, layers, lightfield, hybrid, automatic };

struct FocusSettings {
    ThinLens lens;  ///< f_number infinity: pinhole. A real lens as `impulse` has its own focal length
    double focus_distance_m = 1;
    Framing framing = Framing::keep;
    FocusMethod method = FocusMethod::scatter;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    Impulse impulse;
    /// Number of impulse responses over the finite depths, 2 to DepthLevels::most_depths. None: enough to
    /// quantise the CoC diameter by less than half a pixel (DepthLevels).
    std::optional<int> depths;
    /// Number of views of `lightfield`, 1 to most_lens_views.
    int views = default_lens_views;
    /// Makes only these pixels, bit-identical to those of the whole image; other pixels are undefined.
    /// Warnings count only these pixels.
    std::optional<Crop> crop;
    /// Memory limit of the splats of `scatter` and `layers`, bytes. If they may need more, the image is made
    /// in strips whose splats need at most a third of it, and records are read again for each strip. The
    /// result is bit-identical.
    std::size_t splat_bytes = std::size_t{672} << 20;
};

struct FocusWarning {
    /// For example "overscan": light from beyond the records reaches the image; "uncovered": the lens sees
    /// surfaces that are not recorded.
    std::string code;
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

struct FocusResult {
    Image image;
    FocusMethod method = FocusMethod::scatter;  ///< the method used; `pinhole` if the aperture is 0
    /// Number of impulse responses: FocusSettings::depths, or the number of different radii; 0 for a pinhole.
    int depths = 0;
    int views = 0;              ///< number of views of `lightfield`
    double largest_coc_px = 0;  ///< largest CoC diameter of a primary node, px of the image
    /// None for an orthographic file.
    std::optional<FocusGeometry> geometry;
    std::vector<FocusWarning> warnings;
};

/// Makes the image, bit-identical for any number of threads. Throws Error(wrong_arguments) if a setting is
/// out of range, if the crop exceeds the image, or if an orthographic file gets a finite f-number;
/// Error(invalid_input) if the file is damaged.
[[nodiscard]] FocusResult focus_picture(FocusFrame& frame, const FocusSettings& settings);
/// Makes a single image of a file. Throws what focus_picture for a FocusFrame throws.
[[nodiscard]] FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings);

/// The pinhole image, summed from the records: bit-identical to part 0 of the file.
[[nodiscard]] Image pinhole_picture(const SampleFileReader& file,
                                    const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
