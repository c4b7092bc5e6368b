// Records of objects in layers and mirrors, and their image by the layers method.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>

#include "focus/layers/layers.h"
#include "pictures/image.h"
#include "records/record.h"
#include "tests/focus/focus_records.h"

namespace postlens::test {

/// The splats of a whole band, for the pixels without its overscan.
inline std::unique_ptr<LayerSplats> splats_of(const RecordBand& band, int overscan_px,
                                              const TableOptions& o = {},
                                              std::shared_ptr<const ResponseModel> response = nullptr) {
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end};
    const RasterWindow picture{band.x_begin + overscan_px, band.x_end - overscan_px - 1,
                               band.y_begin + overscan_px, band.y_end - overscan_px - 1};
    auto splats = std::make_unique<LayerSplats>(source, picture, o.geometry,
                                                DepthLevels(o.geometry, range_of(band), o.spacing, o.depths),
                                                o.model, std::move(response));
    splats->add_rows(band, band.y_begin, band.y_end);
    splats->finish();
    return splats;
}

/// The image of a band by the layers method.
inline Image layered(const RecordBand& band, int overscan_px, const TableOptions& options = {}) {
    Image image;
    layers(*splats_of(band, overscan_px, options), image);
    return image;
}

/// A record of object `id` at a depth and in a layer.
inline Record of(std::uint32_t id, double z_m, const std::array<float, 3>& rgb, std::uint32_t layer = 0) {
    Record r = corner(z_m, rgb[0], rgb[1], rgb[2]);
    r.id = id;
    r.layer = layer;
    return r;
}

inline constexpr std::array<float, 3> red{1, 0.5F, 0}, blue{0, 0.25F, 1};

/// The path of a node after one reflection.
inline constexpr NodePath reflected_path = NodePath().child(NodePath::Bounce::reflected);

/// A record of object `id` that a mirror shows.
inline Record shown(std::uint32_t id, double z_m, const std::array<float, 3>& rgb,
                    NodePath path = reflected_path, std::uint32_t layer = 0) {
    Record r = of(id, z_m, rgb, layer);
    r.path = path;
    return r;
}

}  // namespace postlens::test
