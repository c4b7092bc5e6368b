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

/// Returns meshes of the directly visible surfaces in a file, one mesh for each recorded instant. Surfaces
/// that are seen by reflection or refraction have no mesh of their own, because they are assumed to move with
/// the mirror or glass.
[[nodiscard]] std::vector<SheetMesh> blur_sheets(const SampleFileReader& file);

struct FieldBlur {
    PatchPicture picture;  ///< in pixels over which nothing moves, `unknown` is 0
    int views = 0;
    /// Weight of each recorded instant in the blurred image; the weights sum to 1.
    std::vector<double> instant_shares;
};

/// Bit of PatchPicture::touched for pixels that must be redrawn.
inline constexpr std::uint8_t wanted_mark = 2;

/// Blurs moving objects as the mean of many views, which are pinhole images at single instants of the
/// exposure. A view is made by reprojecting the surfaces from the recorded instants before and after it.
/// - `motion`: maps image positions from one instant to another
/// - `ids`: the motion of the objects, with the distance that each one moves
/// - `wanted_ids` (sorted): the objects to blur; image tiles that they cannot reach are not computed
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Draws views (images of the surfaces at different instants) and averages them, in those image tiles that
/// overlap `crop`. The result is needed only in pixels over which an object moves, because all others show
/// the static image. In these others, PatchPicture::unknown, the fraction of the views that show no recorded
/// surface, is set to 0, because missing surfaces do not matter there.
///
/// `field.sets` must have one element, the views to draw. `field.class_marks`, a bit mask for each class of
/// objects, must not be empty, because these bits tell which objects move.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Copies the blurred moving objects from `seen` to `image`, in pixels over which objects of certain classes
/// pass: those with one of the bits `marks` in PatchPicture::touched. Where `seen` shows no recorded surface
/// for a part of the exposure, this part is filled with the colour of `behind`.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
