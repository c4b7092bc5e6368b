#include "motionblur/vector_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/memory.h"
#include "core/threads.h"

namespace postlens {
namespace {

constexpr float same_depth = 0.02F, same_vector_px = 2, same_vector_share = 0.1F, nearly_equal_px = 0.25F;

struct Square {
    int x = 0, y = 0, width = 1, height = 1;  ///< px
    const VectorPixel* pixel = nullptr;
    std::array<glm::vec2, 4> velocity{};  ///< of its corners: up-left, up-right, down-left, down-right
    [[nodiscard]] bool still() const {
        return std::all_of(velocity.begin(), velocity.end(), [](glm::vec2 v) { return v == glm::vec2(0); });
    }
};

class MeshBuilder {
  public:
    explicit MeshBuilder(const VectorFrame& frame) : frame_(frame) {}

    SampleMesh build() {
        mesh_.x_begin = std::min(0, frame_.x_begin);
        mesh_.y_begin = std::min(0, frame_.y_begin);
        mesh_.x_end = std::max(frame_.width, frame_.x_end);
        mesh_.y_end = std::max(frame_.height, frame_.y_end);
        find_tiles();
        const std::uint64_t vertices = std::uint64_t{4} * squares_;
        require_memory(vertices * 8 * sizeof(float) + squares_ * sizeof(MicroQuad), "the mesh of pixels");
        for (auto* of_vertices : {&mesh_.x, &mesh_.y, &mesh_.inverse_z, &mesh_.vx, &mesh_.vy})
            of_vertices->resize(vertices);
        mesh_.rgb.resize(vertices);
        mesh_.quads.resize(squares_);
        std::vector<std::array<MeshBlock, 2>> blocks(tiles_.size());
        parallel_for(tiles_.size(), [&](std::size_t t) { blocks[t] = fill(tiles_[t]); });
        for (const auto& pair : blocks) {
            for (const MeshBlock& b : pair) {
                if (b.quads > 0) mesh_.blocks.push_back(b);
            }
        }
        return std::move(mesh_);
    }

  private:
    static constexpr int edge = SampleMesh::block_px;
    struct Tile {
        int x = 0, y = 0;
        std::uint32_t first_square = 0;
        bool empty = false;  ///< of the display window alone, away from all that is stored: one square
    };

    [[nodiscard]] const VectorPixel* at(int x, int y) const {
        static const VectorPixel nothing;
        if (frame_.stores(x, y)) return &frame_.at(x, y);
        return x >= 0 && y >= 0 && x < frame_.width && y < frame_.height ? &nothing : nullptr;
    }

    template <typename Visit>
    void each_pixel(const Tile& tile, const Visit& visit) const {
        for (int y = tile.y; y < std::min(tile.y + edge, mesh_.y_end); ++y) {
            for (int x = tile.x; x < std::min(tile.x + edge, mesh_.x_end); ++x) {
                if (const VectorPixel* p = at(x, y)) visit(x, y, *p);
            }
        }
    }

    [[nodiscard]] Tile tile_at(int x, int y) const {
        Tile tile{x, y, squares_};
        tile.empty =
            x + edge < frame_.x_begin || x > frame_.x_end || y + edge < frame_.y_begin || y > frame_.y_end;
        return tile;
    }

    /// The part of an empty tile that the display window shows; no width or height: none.
    [[nodiscard]] Square shown(const Tile& tile) const {
        static const VectorPixel nothing;
        const int x = std::max(tile.x, 0), y = std::max(tile.y, 0);
        return {x,
                y,
                std::min(tile.x + edge, frame_.width) - x,
                std::min(tile.y + edge, frame_.height) - y,
                &nothing,
                {}};
    }

    void find_tiles() {
        for (int y = mesh_.y_begin; y < mesh_.y_end; y += edge) {
            for (int x = mesh_.x_begin; x < mesh_.x_end; x += edge) {
                const Tile tile = tile_at(x, y);
                if (tile.empty) {
                    const Square s = shown(tile);
                    if (s.width > 0 && s.height > 0) ++squares_;
                } else {
                    each_pixel(tile, [&](int, int, const VectorPixel&) { ++squares_; });
                }
                if (squares_ > tile.first_square) tiles_.push_back(tile);
            }
        }
    }

    /// Velocity of a corner of a pixel: the mean over those of the four around it that are one surface with
    /// it. `dx`, `dy`: -1 or 1, the corner's side.
    [[nodiscard]] glm::vec2 corner(int x, int y, const VectorPixel& p, int dx, int dy) const {
        const auto joined = [&](const VectorPixel* a, const VectorPixel* b) {
            return a != nullptr && b != nullptr && one_surface(*a, *b, frame_.has_z);
        };
        const VectorPixel *side = at(x + dx, y), *over = at(x, y + dy), *across = at(x + dx, y + dy);
        const bool to_side = joined(&p, side), to_over = joined(&p, over);
        const bool side_across = joined(side, across), over_across = joined(over, across);
        const bool has_across = (to_side && side_across) || (to_over && over_across);
        // Summed from the upper left on, so that all who share the corner have the same bits.
        const VectorPixel* parts[2][2];
        const int i = dx < 0 ? 1 : 0, j = dy < 0 ? 1 : 0;
        parts[j][i] = &p;
        parts[j][1 - i] = to_side || (has_across && side_across) ? side : nullptr;
        parts[1 - j][i] = to_over || (has_across && over_across) ? over : nullptr;
        parts[1 - j][1 - i] = has_across ? across : nullptr;
        glm::vec2 sum(0);
        float count = 0;
        for (const auto& row : parts) {
            for (const VectorPixel* part : row) {
                if (part == nullptr) continue;
                sum += glm::vec2(part->right_px, part->down_px);
                ++count;
            }
        }
        return sum / count;
    }

    std::array<MeshBlock, 2> fill(const Tile& tile) {
        std::array<std::vector<Square>, 2> squares;  // by id
        if (tile.empty) {
            squares[still_id].push_back(shown(tile));
            return place(tile, squares);
        }
        each_pixel(tile, [&](int x, int y, const VectorPixel& p) {
            Square s{x, y, 1, 1, &p, {}};
            for (int k = 0; k < 4; ++k) {
                s.velocity[static_cast<std::size_t>(k)] =
                    corner(x, y, p, (k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1);
            }
            squares[s.still() ? still_id : moving_id].push_back(s);
        });
        return place(tile, squares);
    }

    std::array<MeshBlock, 2> place(const Tile& tile, const std::array<std::vector<Square>, 2>& squares) {
        std::array<MeshBlock, 2> out;
        std::uint32_t square = tile.first_square;
        for (const std::uint32_t id : {still_id, moving_id}) {
            MeshBlock& block = out[id];
            block.id = id;
            block.first_quad = square;
            block.first_vertex = 4 * square;
            block.quads = static_cast<std::uint32_t>(squares[id].size());
            block.vertices = 4 * block.quads;
            if (block.quads == 0) continue;
            for (const Square& s : squares[id]) add(s, block.first_vertex, square++);
            const auto range = [&](const std::vector<float>& v, float& low, float& high) {
                const auto first = v.begin() + block.first_vertex;
                const auto [a, b] = std::minmax_element(first, first + block.vertices);
                low = *a;
                high = *b;
            };
            range(mesh_.x, block.x_min, block.x_max);
            range(mesh_.y, block.y_min, block.y_max);
            range(mesh_.inverse_z, block.inverse_z_min, block.inverse_z_max);
            range(mesh_.vx, block.vx_min, block.vx_max);
            range(mesh_.vy, block.vy_min, block.vy_max);
        }
        return out;
    }

    void add(const Square& s, std::uint32_t block_vertex, std::uint32_t square) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::size_t v = 4 * static_cast<std::size_t>(square) + k;
            mesh_.x[v] = static_cast<float>(s.x + ((k & 1U) != 0 ? s.width : 0));
            mesh_.y[v] = static_cast<float>(s.y + ((k >> 1U) != 0 ? s.height : 0));
            mesh_.inverse_z[v] = s.pixel->inverse_z;
            mesh_.rgb[v] = s.pixel->rgb;
            mesh_.vx[v] = s.velocity[k].x;
            mesh_.vy[v] = s.velocity[k].y;
            mesh_.quads[square].vertex[k] = 4 * square + k - block_vertex;
        }
    }

    const VectorFrame& frame_;
    SampleMesh mesh_;
    std::vector<Tile> tiles_;
    std::uint32_t squares_ = 0;
};

}  // namespace

bool one_surface(const VectorPixel& a, const VectorPixel& b, bool has_z) {
    const float apart = std::hypot(a.right_px - b.right_px, a.down_px - b.down_px);
    if (apart <= nearly_equal_px) return true;
    const float longer = std::max(std::hypot(a.right_px, a.down_px), std::hypot(b.right_px, b.down_px));
    if (apart > std::max(same_vector_px, same_vector_share * longer)) return false;
    if (a.id != 0 && b.id != 0) return a.id == b.id;
    return !has_z || std::abs(a.inverse_z - b.inverse_z) <= same_depth * std::max(a.inverse_z, b.inverse_z);
}

SampleMesh vector_mesh(const VectorFrame& frame) {
    return MeshBuilder(frame).build();
}

}  // namespace postlens
