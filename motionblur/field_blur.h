// Motion blur by light field: the recorded surfaces, moved rigidly to many instants of the shutter.
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
    std::optional<int> views;  ///< instants, 1..most_views; absent: by the longest way
    /// Only tiles that have something of it are drawn; the others are left untouched.
    std::optional<Crop> crop;
};

/// The surfaces of a file, by instant; what is seen in mirrors and through glass goes along with those.
[[nodiscard]] std::vector<SheetMesh> blur_sheets(const SampleFileReader& file);

struct FieldBlur {
    PatchPicture picture;  ///< what is not touched is black and not unknown
    int views = 0;
    std::vector<double> instant_shares;  ///< how much of the exposure each stands for; adds up to 1
};

/// In PatchPicture::touched: one of the wanted ids was there.
inline constexpr std::uint8_t wanted_mark = 2;

/// Views at evenly frequent instants of the shutter, each with a place of its own in the pixel. At every
/// instant the two recorded instants around it are moved there and blended. Those of `ids` that stand still
/// are not moved, whatever their keys say. `wanted_ids` (sorted): only tiles that these may touch are
/// computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Draws the views of a field, of one set and with marks, as far as `crop` goes: what is not touched is black
/// and not unknown.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Puts what the views show into `image`, of the same size, in the pixels touched by one of `marks`. Where
/// part of a pixel is unknown, `behind` stands in for that part; it may be empty where nothing is.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
