#include "motionblur/vectors/vector_sheets.h"

#include <algorithm>
#include <cmath>

#include "core/memory.h"
#include "core/threads.h"

namespace postlens {
namespace {

constexpr float same_depth = 0.02F, same_vector_px = 2, same_vector_share = 0.1F, nearly_equal_px = 0.25F;

constexpr int edge = SheetMesh::square_px;
constexpr std::size_t values = 5;  ///< values per cell: 1/z' and the four entries of the matrix W

struct SquareSheets {
    std::vector<Sheet> sheets;
    std::vector<std::uint32_t> cells;  ///< SheetMesh::fine, which is equal to SheetMesh::coarse
    std::vector<CellPlane> planes;
    std::vector<Texel> texels;
};

class SheetMaker {
  public:
    explicit SheetMaker(const VectorFrame& frame)
        : frame_(frame),
          x_begin_(std::min(0, frame.x_begin)),
          y_begin_(std::min(0, frame.y_begin)),
          x_end_(std::max(frame.width, frame.x_end)),
          y_end_(std::max(frame.height, frame.y_end)) {}

    SheetMesh make() {
        const auto columns = static_cast<std::size_t>((x_end_ - x_begin_ + edge - 1) / edge),
                   rows = static_cast<std::size_t>((y_end_ - y_begin_ + edge - 1) / edge);
        const auto stored = static_cast<std::uint64_t>(std::max(0, frame_.x_end - frame_.x_begin)) *
                            static_cast<std::uint64_t>(std::max(0, frame_.y_end - frame_.y_begin));
        // Memory, in bytes, for each pixel that the frame stores. The pixels are converted to sheets (parts
        // of surfaces) with planes, nodes and texels for each pixel. require_memory() requires twice this
        // memory, because an array that grows reserves up to twice the memory that it uses.
        constexpr std::uint64_t cell_bytes =
            2 * values * sizeof(CellPlane) + 2 * sizeof(std::uint32_t) + sizeof(Texel) + sizeof(float);
        require_memory(
            2 * stored * cell_bytes + columns * rows * (sizeof(Sheet) + values * sizeof(CellPlane)),
            "the sheets of pixels");
        mesh_.values = values;
        add_nothing();
        for (std::size_t row = 0; row < rows; ++row) {
            std::vector<SquareSheets> squares(columns);
            parallel_for(columns, [&](std::size_t column) {
                make_square(x_begin_ + static_cast<int>(column) * edge,
                            y_begin_ + static_cast<int>(row) * edge, squares[column]);
            });
            for (const SquareSheets& square : squares) append(square);
        }
        mesh_.coarse = mesh_.fine;
        mesh_.bends.assign(mesh_.fine.size(), 0.0F);
        return std::move(mesh_);
    }

  private:
    /// Adds an empty square of texels, which are black, to the mesh of the image. All squares of the image in
    /// which the file stores no pixels refer to it.
    void add_nothing() {
        mesh_.fine.assign(std::size_t{edge} * edge, SheetNode::leaf);
        mesh_.planes.assign(mesh_.fine.size() * values, {});
        mesh_.texels.push_back({});
        Sheet none;  // the sheet to which the black texel belongs
        none.key.id = still_id;
        none.width = none.height = 0;
        mesh_.sheets.push_back(none);
    }

    [[nodiscard]] const VectorPixel* at(int x, int y) const {
        static const VectorPixel nothing;
        if (frame_.stores(x, y)) return &frame_.at(x, y);
        return x >= 0 && y >= 0 && x < frame_.width && y < frame_.height ? &nothing : nullptr;
    }

    void make_square(int x0, int y0, SquareSheets& out) const {
        const bool stores_none = x0 + edge < frame_.x_begin || x0 > frame_.x_end ||
                                 y0 + edge < frame_.y_begin || y0 > frame_.y_end;
        if (stores_none) {
            Sheet s;
            s.key.id = still_id;
            s.x = std::max(x0, 0);
            s.y = std::max(y0, 0);
            s.width = std::min(x0 + edge, frame_.width) - s.x;
            s.height = std::min(y0 + edge, frame_.height) - s.y;
            if (s.width > 0 && s.height > 0) out.sheets.push_back(s);
            return;
        }
        struct Cell {
            const VectorPixel* pixel = nullptr;
            /// Velocities of the pixel's corners: up-left, up-right, down-left, down-right.
            std::array<glm::vec2, 4> velocity{};
            bool still = true, taken = false;
        };
        std::array<Cell, std::size_t{edge} * edge> cells;
        const auto cell = [&](int x, int y) -> Cell& {
            return cells[static_cast<std::size_t>(y) * edge + static_cast<std::size_t>(x)];
        };
        for (int y = 0; y < std::min(edge, y_end_ - y0); ++y) {
            for (int x = 0; x < std::min(edge, x_end_ - x0); ++x) {
                Cell& c = cell(x, y);
                c.pixel = at(x0 + x, y0 + y);
                if (c.pixel == nullptr) continue;
                for (int k = 0; k < 4; ++k) {
                    const glm::vec2 v =
                        corner(x0 + x, y0 + y, *c.pixel, (k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1);
                    c.velocity[static_cast<std::size_t>(k)] = v;
                    c.still = c.still && v == glm::vec2(0);
                }
            }
        }
        // Divides a square of pixels into surfaces. A surface consists of connected pixels. Either all of
        // them move, or none does, and their depths (`inverse_z`, inverse depth) are close to that of the
        // pixel at which the search for the surface begins.
        std::vector<glm::ivec2> open, found;
        for (int i = 0; i < edge * edge; ++i) {
            const Cell& first = cells[static_cast<std::size_t>(i)];
            if (first.pixel == nullptr || first.taken) continue;
            found.clear();
            const auto visit = [&](int x, int y) {
                if (x < 0 || y < 0 || x >= edge || y >= edge) return;
                Cell& c = cell(x, y);
                if (c.pixel == nullptr || c.taken || c.still != first.still) return;
                const float a = c.pixel->inverse_z, b = first.pixel->inverse_z;
                if (std::abs(a - b) > same_depth * std::max(a, b)) return;
                c.taken = true;
                open.emplace_back(x, y);
                found.emplace_back(x, y);
            };
            visit(i % edge, i / edge);
            while (!open.empty()) {
                const glm::ivec2 p = open.back();
                open.pop_back();
                visit(p.x - 1, p.y);
                visit(p.x + 1, p.y);
                visit(p.x, p.y - 1);
                visit(p.x, p.y + 1);
            }
            glm::ivec2 low = found.front(), high = low;
            for (const glm::ivec2& p : found) {
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
            Sheet s;
            s.key.id = first.still ? still_id : moving_id;
            s.x = x0 + low.x;
            s.y = y0 + low.y;
            s.width = high.x - low.x + 1;
            s.height = high.y - low.y + 1;
            s.first_cell = static_cast<std::uint32_t>(out.cells.size());
            s.inverse_z_min = s.inverse_z_max = first.pixel->inverse_z;
            const auto number = static_cast<std::uint32_t>(out.sheets.size());
            out.cells.resize(out.cells.size() + static_cast<std::size_t>(s.width * s.height),
                             SheetNode::none);
            out.planes.resize(out.cells.size() * values);
            for (const glm::ivec2& p : found) {
                const Cell& c = cell(p.x, p.y);
                const std::size_t k =
                    s.first_cell + static_cast<std::size_t>((p.y - low.y) * s.width + p.x - low.x);
                out.cells[k] = SheetNode::leaf | static_cast<std::uint32_t>(out.texels.size());
                const auto& rgb = c.pixel->rgb;
                out.texels.push_back({rgb[0], rgb[1], rgb[2], Texel::info_of(number, 0)});
                const auto& v = c.velocity;
                const glm::vec2 middle = (v[0] + v[1] + v[2] + v[3]) / 4.0F,
                                by_x = (v[1] + v[3] - v[0] - v[2]) / 2.0F,
                                by_y = (v[2] + v[3] - v[0] - v[1]) / 2.0F;
                CellPlane* plane = out.planes.data() + k * values;
                plane[0] = {c.pixel->inverse_z, 0, 0};
                plane[1] = {-middle.x, -by_x.x, -by_y.x};
                plane[3] = {-middle.y, -by_x.y, -by_y.y};
                s.inverse_z_min = std::min(s.inverse_z_min, c.pixel->inverse_z);
                s.inverse_z_max = std::max(s.inverse_z_max, c.pixel->inverse_z);
            }
            out.sheets.push_back(s);
        }
    }

    /// Returns the velocity at one corner of pixel (x, y). This is the mean over the pixels around the corner
    /// that show the same surface as (x, y). `dx` and `dy` (-1 or 1) select the corner.
    [[nodiscard]] glm::vec2 corner(int x, int y, const VectorPixel& p, int dx, int dy) const {
        const auto joined = [&](const VectorPixel* a, const VectorPixel* b) {
            return a != nullptr && b != nullptr && one_surface(*a, *b, frame_.has_z);
        };
        const VectorPixel *side = at(x + dx, y), *over = at(x, y + dy), *across = at(x + dx, y + dy);
        const bool to_side = joined(&p, side), to_over = joined(&p, over);
        const bool side_across = joined(side, across), over_across = joined(over, across);
        const bool has_across = (to_side && side_across) || (to_over && over_across);
        // `parts` holds the pixels around the corner that show the same surface as `p`, arranged by row and
        // column. Their velocities are always added in this order, so that the rounding of the sum does not
        // depend on which of them is `p`.
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

    void append(const SquareSheets& square) {
        const auto sheets = static_cast<std::uint32_t>(mesh_.sheets.size()),
                   cells = static_cast<std::uint32_t>(mesh_.fine.size()),
                   texels = static_cast<std::uint32_t>(mesh_.texels.size());
        for (Sheet s : square.sheets) {
            if (!square.cells.empty()) s.first_cell += cells;  // otherwise the shared black cells
            mesh_.sheets.push_back(s);
        }
        for (const std::uint32_t c : square.cells)
            mesh_.fine.push_back(c == SheetNode::none ? c : c + texels);
        mesh_.planes.insert(mesh_.planes.end(), square.planes.begin(), square.planes.end());
        for (Texel t : square.texels) {
            t.info += sheets << Texel::sheet_shift;
            mesh_.texels.push_back(t);
        }
    }

    const VectorFrame& frame_;
    int x_begin_, y_begin_, x_end_, y_end_;
    SheetMesh mesh_;
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

SheetMesh vector_sheets(const VectorFrame& frame) {
    return SheetMaker(frame).make();
}

}  // namespace postlens
