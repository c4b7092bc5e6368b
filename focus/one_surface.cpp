#include "focus/one_surface.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// How much a patch may be stretched by looking from the rim of the lens.
constexpr double most_stretch = 0.25;
constexpr std::uint32_t nobody = 0xFFFFFFFFU, several = 0xFFFFFFFEU;

/// The cells that a rectangle of the raster touches.
template <typename Visit>
void each_cell(const RasterRect& r, const RasterWindow& window, int columns, int rows, const Visit& visit) {
    const auto cell = [](double px, int begin, int count) {
        return static_cast<int>(
            std::clamp(std::floor((px - begin) / OneSurface::edge), -1.0, static_cast<double>(count)));
    };
    // A pixel of margin: the filter of the pixels and of what scatters.
    const int x0 = std::max(0, cell(r.x_min - 1, window.x_begin, columns)),
              x1 = std::min(columns - 1, cell(r.x_max + 1, window.x_begin, columns)),
              y0 = std::max(0, cell(r.y_min - 1, window.y_begin, rows)),
              y1 = std::min(rows - 1, cell(r.y_max + 1, window.y_begin, rows));
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x)
            visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(x));
    }
}

}  // namespace

double OneSurface::share() const {
    return static_cast<double>(std::count(cells.begin(), cells.end(), 1)) /
           static_cast<double>(std::max<std::size_t>(cells.size(), 1));
}

bool OneSurface::all(int x, int y, int width, int height) const {
    for (int j = y / edge; j <= (y + height - 1) / edge; ++j) {
        for (int i = x / edge; i <= (x + width - 1) / edge; ++i) {
            if (!at(i * edge, j * edge)) return false;
        }
    }
    return true;
}

OneSurface find_one_surface(const PatchMesh& primary, const PatchMesh& deeper, const glm::dvec2& lens_px,
                            double inverse_focus_per_m, const RasterWindow& window) {
    OneSurface out;
    out.columns = (window.width() + OneSurface::edge - 1) / OneSurface::edge;
    out.rows = (window.height() + OneSurface::edge - 1) / OneSurface::edge;
    const auto count = static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows);
    std::vector<std::uint32_t> owner(count, nobody);
    std::vector<double> recorded(count, 0);  // area of the recorded patches that lie there, unmoved
    for (const PatchMesh* mesh : {&primary, &deeper}) {
        for (const Patch& p : mesh->patches) {
            RasterRect swept;
            PatchPlace place;
            double stretch = 0;
            for (int k = 0; k < 4; ++k) {
                const glm::dvec2 q((k & 1) != 0 ? lens_px.x : -lens_px.x,
                                   (k & 2) != 0 ? lens_px.y : -lens_px.y);
                if (!place_patch(*mesh, p, {}, {q, inverse_focus_per_m, {}}, place)) continue;
                swept.add(covered(p, place));
                const glm::dmat2 d = place.move - glm::dmat2(1);
                stretch = std::max(
                    {stretch, std::abs(d[0].x), std::abs(d[0].y), std::abs(d[1].x), std::abs(d[1].y)});
            }
            const SheetKey& key = mesh->sheet(p).key;
            const std::uint32_t id = mesh == &deeper || stretch > most_stretch ? several : key.id;
            each_cell(swept, window, out.columns, out.rows, [&](std::size_t c) {
                if (owner[c] == nobody) owner[c] = id;
                if (owner[c] != id) owner[c] = several;
            });
            if (mesh == &deeper) continue;
            // One surface seen twice lies over itself: more area than the cell has.
            const glm::dvec2 corner = mesh->corner(p);
            for (int y = 0; y < p.height; ++y) {
                for (int x = 0; x < p.width; ++x) {
                    const int i = static_cast<int>(corner.x) + x - window.x_begin,
                              j = static_cast<int>(corner.y) + y - window.y_begin;
                    if (i < 0 || j < 0 || i >= window.width() || j >= window.height()) continue;
                    const Sheet& s = mesh->sheet(p);
                    const std::size_t cell =
                        s.first_cell + static_cast<std::size_t>(p.y + y) * static_cast<std::size_t>(s.width) +
                        static_cast<std::size_t>(p.x + x);
                    if (mesh->sheets->fine[cell] == SheetNode::none) continue;
                    recorded[static_cast<std::size_t>(j / OneSurface::edge) *
                                 static_cast<std::size_t>(out.columns) +
                             static_cast<std::size_t>(i / OneSurface::edge)] += 1;
                }
            }
        }
    }
    out.cells.resize(count);
    for (std::size_t c = 0; c < count; ++c) {
        out.cells[c] =
            owner[c] != nobody && owner[c] != several && recorded[c] <= OneSurface::edge * OneSurface::edge
                ? 1
                : 0;
    }
    return out;
}

}  // namespace postlens
