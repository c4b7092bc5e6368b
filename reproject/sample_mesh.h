// The records of one instant as a mesh of micro-quads: what can be drawn as seen from elsewhere.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Surfaces of one id within one square of the raster. The four corners of a leaf of the quadtree that see
/// one surface make a micro-quad; where a corner sees another, or the depth jumps, each corner has the
/// quarter of the leaf next to it, at its own depth.
struct MeshBlock {
    std::uint32_t id = 0;
    std::uint32_t first_vertex = 0, vertices = 0;
    std::uint32_t first_quad = 0, quads = 0;
    /// Of the vertices; px and 1/m.
    float x_min = 0, x_max = 0, y_min = 0, y_max = 0, inverse_z_min = 0, inverse_z_max = 0;
    float vx_min = 0, vx_max = 0, vy_min = 0, vy_max = 0;  ///< px per unit of time; 0 without velocities
};

/// Indices into the block's vertices: up-left, up-right, down-left, down-right.
struct MicroQuad {
    std::array<std::uint32_t, 4> vertex{};
};

struct SampleMesh {
    static constexpr int block_px = 16;  ///< edge of a block's square

    double time_s = 0;
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;  ///< pixels that have records, overscan included
    std::vector<MeshBlock> blocks;
    std::vector<float> x, y, inverse_z;     ///< of the vertices
    std::vector<std::array<float, 3>> rgb;  ///< scene-linear, the sum of the shading tree's nodes
    std::vector<MicroQuad> quads;
    /// px per unit of time, of the vertices: the motion, in place of any map, of a mesh that was made from
    /// motion vectors. Empty: by maps.
    std::vector<float> vx, vy;
    [[nodiscard]] bool has_velocities() const { return !vx.empty(); }
};

/// Reads an instant of the file. Throws Error(out_of_memory) before it would take more than there is, and
/// what the reader throws.
[[nodiscard]] SampleMesh sample_mesh(const SampleFileReader& file, std::size_t instant = 0);

}  // namespace postlens
