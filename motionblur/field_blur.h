// Motion blur by the light field method: the recorded surfaces are moved rigidly to many instants of the
// exposure, and the resulting images are averaged.
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
    /// Number of instants, 1..most_views. If absent, it is chosen from the longest path.
    std::optional<int> views;
    /// Only tiles that overlap the crop are drawn. All other tiles stay as they are.
    std::optional<Crop> crop;
};

/// Returns the directly visible surfaces of a file, one mesh per recorded instant. A mirror or glass is drawn
/// with the colours that are seen in it or through it. These colours move with its surface.
[[nodiscard]] std::vector<SheetMesh> blur_sheets(const SampleFileReader& file);

struct FieldBlur {
    PatchPicture picture;  ///< in pixels over which nothing moves, `unknown` is 0
    int views = 0;
    /// Weight of each recorded instant in the blurred image; the weights sum to 1.
    std::vector<double> instant_shares;
};

/// Bit of PatchPicture::touched. It is set in pixels that show an object of `wanted_ids`, in the records or
/// in a view. It is also set where a view finds no recorded surface.
inline constexpr std::uint8_t wanted_mark = 2;

/// Blurs moving objects as the mean of many views. A view is an image at one instant: a blend of the recorded
/// instants just before and after it, both reprojected to the view's instant. The views are closer in time
/// while the shutter transmits more light. Each view has its own sample position in the pixel.
///
/// `ids` states how objects move; those of kind `still` stay in place, even if their recorded positions
/// differ. Only tiles over which an object of `wanted_ids` (sorted) may pass are computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Averages the views (reprojected images) of `field` in the tiles that overlap `crop`. Pixels over which
/// nothing moves (`touched` is 0) get `unknown` 0. `field` must have one element of `sets`, and `class_marks`
/// must not be empty, so that `touched` is computed.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Copies the pixels of `seen` whose `touched` contains a bit of `marks` to `image`, which has the same size.
/// The unrecorded fraction of a pixel (`unknown`) is filled with the colour of `behind`, which may be empty
/// if all fractions are 0.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
