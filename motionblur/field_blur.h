// Motion blur by a light field over time: the mean of images at many instants.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"
#include "records/sample_file.h"
#include "reproject/patch_field.h"

namespace postlens {

struct FieldBlurSettings {
    Exposure exposure;
    ShutterCurve curve = ShutterCurve::box();
    /// Number of instants whose images are averaged, 1..most_views. If absent, it is chosen from the longest
    /// motion path of an object.
    std::optional<int> views;
    /// Part of the image to draw. Only tiles of the image that overlap it are drawn; other tiles stay as they
    /// are.
    std::optional<Crop> crop;
};

/// Returns one mesh per recorded instant, made from the directly visible surfaces of a file. Reflections and
/// refractions have no mesh: they are assumed to move with the mirror or glass.
[[nodiscard]] std::vector<SheetMesh> blur_sheets(const SampleFileReader& file);

struct FieldBlur {
    PatchPicture picture;  ///< in pixels over which nothing moves, `unknown` is 0
    int views = 0;
    /// Weight of each recorded instant in the blurred image; the weights sum to 1.
    std::vector<double> instant_shares;
};

/// Bit of PatchPicture::touched for pixels that must be redrawn.
inline constexpr std::uint8_t wanted_mark = 2;

/// Blurs moving objects as the mean of many views. A view is the pinhole image at one instant, reprojected
/// from the recorded instants before and after it.
///
/// `motion` maps image positions from one instant to another, and `ids` lists which objects move and how far.
/// `wanted_ids` (sorted) are the objects to blur. Image tiles that they cannot reach are not computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Draws the mean of the views (images at different instants) in the image tiles that overlap `crop`. Pixels
/// over which no object moves get PatchPicture::unknown = 0, because they keep the colours of the static
/// image.
///
/// `field.sets` must have one element. `field.class_marks` must not be empty, because it marks moving
/// objects.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Copies the pixels of `seen` that have one of the flags `marks` to `image`. Fills gaps with the colours of
/// `behind`.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
