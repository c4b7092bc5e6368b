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
    /// path.
    std::optional<int> views;
    /// Part of the image to draw. Only tiles of the image that overlap it are drawn; other tiles stay as they
    /// are.
    std::optional<Crop> crop;
};

/// Returns the directly visible surfaces of a file, one mesh per recorded instant. The colours seen in a
/// mirror or glass move with its surface.
[[nodiscard]] std::vector<SheetMesh> blur_sheets(const SampleFileReader& file);

struct FieldBlur {
    PatchPicture picture;  ///< in pixels over which nothing moves, `unknown` is 0
    int views = 0;
    /// Weight of each recorded instant in the blurred image; the weights sum to 1.
    std::vector<double> instant_shares;
};

/// Bit of PatchPicture::touched. It marks pixels that show an object of `wanted_ids`, or where a view finds
/// no recorded surface.
inline constexpr std::uint8_t wanted_mark = 2;

/// Blurs moving objects as the mean of many views. A view is an image at one instant, blended from the
/// recorded instants before and after it.
///
/// `ids` states how objects move. Only tiles over which objects of `wanted_ids` (sorted) pass are computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Averages the views (reprojected images) of `field` in the tiles that overlap `crop`. Where nothing moves,
/// `unknown` is 0.
///
/// `field` must have exactly one element in `sets`, and `class_marks` must not be empty.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Copies the pixels of `seen` whose `touched` contains a bit of `marks` to `image`. Their unrecorded
/// fraction (`unknown`) is filled with `behind`, which may be empty if there is none.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
