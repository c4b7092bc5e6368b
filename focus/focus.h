// Computes the image that a lens forms, from a sample file (samples of surfaces with their depths).
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

/// The methods of computing an image. focus_picture implements all but `hybrid` (planner/hybrid.h) and
/// `automatic` (planner/auto_picture.h).
enum class FocusMethod { pinhole, scatter, layers, lightfield, hybrid, automatic };

struct FocusSettings {
    /// An infinite f-number means a pinhole. If `impulse` selects a real lens (ImpulseKind::lens), the focal
    /// length of that lens replaces `lens.focal_length_mm`.
    ThinLens lens;
    double focus_distance_m = 1;
    Framing framing = Framing::keep;
    FocusMethod method = FocusMethod::scatter;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    Impulse impulse;
    /// Number of depths for which blur kernels are computed, from 2 to DepthLevels::most_depths. Every
    /// surface sample uses the kernel of the nearest of these depths. More depths are more accurate, but need
    /// more memory and time.
    ///
    /// If this is not set, depths are chosen so densely that using the nearest one changes the CoC diameter
    /// of a sample by less than half a pixel. The change may be larger for diameters above 2048 px, or if the
    /// depths have equal distances in metres (`spacing` is DepthSpacing::linear).
    std::optional<int> depths;
    /// Number of lens points from which the method `lightfield` makes images, 1 to most_lens_views.
    int views = default_lens_views;
    /// If set, only the pixels in this rectangle are computed. They are bit-identical to the same pixels of
    /// the whole image. All pixels outside the rectangle are undefined.
    std::optional<Crop> crop;
    /// Memory limit, in bytes, for the blurred samples of the methods `scatter` and `layers`. Larger images
    /// are computed in groups of rows, with bit-identical results.
    std::size_t splat_bytes = std::size_t{672} << 20;
};

struct FocusWarning {
    /// Kind of warning, for example:
    /// - "overscan": light from beyond the recorded pixels is missing in the image
    /// - "uncovered": the lens sees surfaces that are not recorded
    std::string code;
    double share = 0;  ///< share of the pixels that are affected
    std::string text;
};

struct FocusResult {
    Image image;
    FocusMethod method = FocusMethod::scatter;  ///< the method used; `pinhole` if the aperture is 0
    /// Number of depths for which blur kernels were computed. It is FocusSettings::depths if that is set.
    /// Otherwise, it is the number of equally spaced depths if the spacing is linear, or else the number of
    /// different CoC radii in use. It is 0 for a pinhole.
    int depths = 0;
    int views = 0;              ///< number of views of `lightfield`
    double largest_coc_px = 0;  ///< largest CoC diameter of a surface seen directly, px of the image
    /// Absent if the file was traced with an orthographic camera.
    std::optional<FocusGeometry> geometry;
    std::vector<FocusWarning> warnings;
};

/// Computes the image that the lens forms. The result is bit-identical for any number of threads.
///
/// Throws Error(wrong_arguments) if a setting is out of range, or if the f-number is finite but the file has
/// an orthographic camera. Throws Error(invalid_input) if the file is damaged.
[[nodiscard]] FocusResult focus_picture(FocusFrame& frame, const FocusSettings& settings);
/// Computes a single image from a sample file. For several images of one file, use focus_picture(FocusFrame&,
/// ...), because a FocusFrame can keep the file's contents in memory between images. Throws the same errors
/// as that function.
[[nodiscard]] FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings);

/// Computes the sharp image of a pinhole camera: the colour of each pixel is the weighted sum of its surface
/// samples. The result is bit-identical to the flat image that the sample file also contains (part 0).
[[nodiscard]] Image pinhole_picture(const SampleFileReader& file,
                                    const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
