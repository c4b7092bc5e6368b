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
    /// Number of instants, 1..most_views; if absent, it depends on the longest displacement.
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
    /// Share of the exposure for each recorded instant; the shares sum to 1.
    std::vector<double> instant_shares;
};

/// Bit of PatchPicture::touched. It is set in pixels where a wanted id is seen.
inline constexpr std::uint8_t wanted_mark = 2;

/// Renders views at instants that are distributed like the shutter's transmission. Each view has its own
/// sample position in the pixel. A view is made from the recorded instants before and after its instant.
/// Their records are reprojected to the view's instant and blended. Objects that `ids` classifies as still
/// are not moved, even if they differ between recorded instants. Only tiles that the objects of `wanted_ids`
/// (sorted) may touch are computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SheetMesh>& sheets,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

/// Draws the views of `field` in the tiles that overlap `crop`. The field must have a single set of views,
/// and its class_marks must not be empty. Pixels over which nothing moves are black and count as known.
[[nodiscard]] PatchPicture touched_picture(PatchField& field, const std::optional<Crop>& crop);

/// Copies the pixels of `seen` that have one of `marks` into `image`, which has the same size. `behind`
/// provides the colour for the unknown share of a pixel's light. If all pixels are known, `behind` may be
/// empty.
void lay_over(Image& image, const PatchPicture& seen, std::uint8_t marks, const Image& behind);

}  // namespace postlens
