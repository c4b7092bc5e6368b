// Motion blur by light field: the recorded surfaces, moved rigidly to many instants of the shutter.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/motion_kinds.h"
#include "records/sample_file.h"
#include "reproject/light_field.h"
#include "reproject/sample_mesh.h"

namespace postlens {

struct FieldBlurSettings {
    Exposure exposure;
    ShutterCurve curve = ShutterCurve::box();
    std::optional<int> views;  ///< instants, 1..most_views; absent: by the longest way
    std::optional<Crop> crop;  ///< as in LightField
};

struct FieldBlur {
    FieldPicture picture;
    int views = 0;
    std::vector<double> mesh_shares;  ///< by mesh: how much of the exposure it stands for; adds up to 1
};

/// In FieldPicture::touched: one of the wanted ids was there.
inline constexpr std::uint8_t wanted_mark = 2;

/// Views at evenly frequent instants of the shutter, each with a place of its own in the pixel. At every
/// instant the two recorded instants around it are moved there and blended. Those of `ids` that stand still
/// are not moved, whatever their keys say. `wanted_ids` (sorted): only tiles that these may touch are
/// computed.
[[nodiscard]] FieldBlur field_blur(const SampleHeader& header, const std::vector<SampleMesh>& meshes,
                                   const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                   const std::vector<std::uint32_t>& wanted_ids,
                                   const FieldBlurSettings& settings);

}  // namespace postlens
