// What the motions of views do to a patch: what its plane of depth has to be exact for, and its size small.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches.h"

namespace postlens {

/// For PatchLens::motion.
struct StrainOfMotions {
    /// By view and motion class, as PatchView::Use::motions: of `strain_views` evenly spread views will do.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// The most in any view; 0 where nothing moves.
    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
inline constexpr int strain_views = 16;

}  // namespace postlens
