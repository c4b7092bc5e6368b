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

/// Returns the directly visible surfaces of a file, one mesh per recorded instant. Surfaces seen by
/// reflection or transmission are drawn as part of the mirror or glass, and move with it.
[[nodiscard]] std::vector<SheetMesh> blur_sheets(const SampleFileReader& file);

struct FieldBlur {
    PatchPicture picture;  ///< pixels over which nothing moves are black and count as known
    int views = 0;
    /// Weight of each recorded instant in the blurred image; the weights sum to 1.
    std::vector<double> instant_shares;
};

/// Bit of PatchPicture::touched. It is set in pixels that show an object of `wanted_ids`, in the records or
/// in a view. It is also set where a view sees something that is not recorded.
inline constexpr std::uint8_t wanted_mark = 2;

/// Averages views (reprojected images) at instants that are distributed like the shutter's transmission. A
/// view blends the records of the recorded instants just before and after it, both reprojected to the view's
/// own instant. Each view has its own sample position in the pixel. Objects that are `still` according to
/// `ids` are not moved, even if their recorded positions differ. Only tiles over which an object of
/// `wanted_ids` (sorted) may pass are computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Averages the views (reprojected images) of `field` in the tiles that overlap `crop`. Pixels over which
/// nothing moves are black, and their share of unknown light is 0. `field` must have exactly one set of
/// views, and its `class_marks` must not be empty.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Copies a pixel of `seen` to `image` if its entry in `touched` has a bit of `marks`. Both images have the
/// same size. Light of the pixel that was not recorded is taken from `behind`, which may be empty if all
/// light was recorded.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
