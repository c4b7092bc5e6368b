// The focus processor. It computes the image that a lens would form, from a sample file.
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

/// The methods of computing an image. focus_picture implements all except `hybrid` (planner/hybrid.h) and
/// `automatic` (planner/auto_picture.h).
enum class FocusMethod { pinhole, scatter, layers, lightfield, hybrid, automatic };

struct FocusSettings {
    ThinLens lens;  ///< f_number infinity: pinhole. A real lens (`impulse`) has its own focal length
    double focus_distance_m = 1;
    Framing framing = Framing::keep;
    FocusMethod method = FocusMethod::scatter;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    Impulse impulse;
    /// Number of impulse responses for the finite depths, 2 to DepthLevels::most_depths. If absent, the
    /// number is chosen so that quantisation changes the CoC diameter by less than half a pixel
    /// (DepthLevels).
    std::optional<int> depths;
    /// Number of views of `lightfield`, 1 to most_lens_views.
    int views = default_lens_views;
    /// If present, only these pixels are computed, bit-identical to those of the whole image. All other
    /// pixels are undefined. Warnings count only these pixels.
    std::optional<Crop> crop;
    /// Memory limit for the splats (impulse responses of samples) of `scatter` and `layers`, bytes. If all
    /// splats may exceed it, the image is made in strips. The splats of a strip need at most a third of the
    /// limit, and records are read again for each strip. The result is bit-identical.
    std::size_t splat_bytes = std::size_t{672} << 20;
};

struct FocusWarning {
    /// For example "overscan" (light from beyond the records reaches the image) or "uncovered" (the lens sees
    /// surfaces that are not recorded).
    std::string code;
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

struct FocusResult {
    Image image;
    FocusMethod method = FocusMethod::scatter;  ///< the method used; `pinhole` if the aperture is 0
    /// Number of impulse responses: FocusSettings::depths if given, otherwise the number of different radii.
    /// 0 for a pinhole.
    int depths = 0;
    int views = 0;              ///< number of views of `lightfield`
    double largest_coc_px = 0;  ///< largest CoC diameter of a surface seen directly, px of the image
    /// None for an orthographic file.
    std::optional<FocusGeometry> geometry;
    std::vector<FocusWarning> warnings;
};

/// Computes the image, bit-identical for any number of threads. Throws Error(wrong_arguments) if a setting is
/// out of range, if the crop exceeds the image, or if the file is orthographic and the f-number is finite.
/// Throws Error(invalid_input) if the file is damaged.
[[nodiscard]] FocusResult focus_picture(FocusFrame& frame, const FocusSettings& settings);
/// Computes a single image of a file. Throws the same errors as focus_picture for a FocusFrame.
[[nodiscard]] FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings);

/// Computes the pinhole image by summing the records. The result is bit-identical to part 0 of the file.
[[nodiscard]] Image pinhole_picture(const SampleFileReader& file,
                                    const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
