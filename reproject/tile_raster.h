// Micro-quads drawn into a small square of the raster, one sample a pixel, nearest first.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reproject/raster_map.h"
#include "reproject/raster_rect.h"
#include "reproject/sample_mesh.h"

namespace postlens {

/// One view of a square of pixels.
struct TileBuffer {
    static constexpr int edge = 64;  ///< px
    static constexpr std::size_t pixels = static_cast<std::size_t>(edge) * edge;
    static constexpr float nothing = -1;  ///< as inverse depth: no surface known there

    std::array<float, pixels> inverse_z{};
    std::array<float, pixels> r{}, g{}, b{};
    std::array<std::uint32_t, pixels> id{};
    std::array<std::uint8_t, pixels> mark{};  ///< of the block that is seen

    void clear() {
        inverse_z.fill(nothing);
        id.fill(0);
        mark.fill(0);
    }
};

/// Where the samples of a tile lie: pixel (i, j) of the tile is sampled at (x + i, y + j), raster px.
struct TileView {
    double x = 0, y = 0;
    int width = TileBuffer::edge, height = TileBuffer::edge;  ///< pixels in use
};

/// Memory of one thread for `draw_block`.
struct DrawScratch {
    std::vector<float> x, y, inverse_z;
    std::vector<std::uint32_t> cell;  ///< column and row of the samples between which the vertex lies
    std::vector<std::uint32_t> hit;   ///< quads that may hold a sample
};

/// The rectangle that a block covers under a map, raster px; the whole plane where a part of it comes to lie
/// beside or behind the camera.
[[nodiscard]] RasterRect covered_rect(const MeshBlock& block, const RasterMap& map);

/// The same for a block of a mesh with velocities, some time after its instant.
[[nodiscard]] RasterRect covered_rect(const MeshBlock& block, double elapsed);

/// Draws a block as `map` moves it. Of surfaces at one pixel the nearest stays, of equals the first drawn.
/// Quads that the map turns over are not drawn: their other side was not recorded.
void draw_block(const SampleMesh& mesh, const MeshBlock& block, const RasterMap& map, std::uint8_t mark,
                const TileView& view, DrawScratch& scratch, TileBuffer& out);
/// The same for a mesh with velocities, some time after its instant: every vertex goes straight on at its
/// own depth.
void draw_block(const SampleMesh& mesh, const MeshBlock& block, double elapsed, std::uint8_t mark,
                const TileView& view, DrawScratch& scratch, TileBuffer& out);

}  // namespace postlens
