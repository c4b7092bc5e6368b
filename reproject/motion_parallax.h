// How far depth moves what moves: what a patch's plane of depth has to be exact for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/raster_map.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

/// The motions of some views by class, as PatchView::Use::motions: those of 16 evenly spread views will do.
struct MotionParallax {
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// px by which what is nearer by 1/m comes to lie elsewhere, at the middle of the sheet and of its
    /// depths, in the view where that is most; 0 where it stands still.
    [[nodiscard]] double operator()(const Sheet& sheet) const;
};
inline constexpr int parallax_views = 16;

}  // namespace postlens
