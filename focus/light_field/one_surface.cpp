#include "focus/light_field/one_surface.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// Limit for the slope of a surface. The image of an inclined surface is stretched or compressed if it is
/// seen from the lens's rim instead of its centre. If its width or height changes by more than the fraction
/// most_stretch, the surface counts as too steep.
constexpr double most_stretch = 0.25;
constexpr std::uint32_t nobody = 0xFFFFFFFFU, several = 0xFFFFFFFEU;

/// The image is divided into cells of 8 x 8 px. Calls visit(index) for each cell that the rectangle `r`
/// covers, where `r` is enlarged by a margin of one pixel.
template <typename Visit>
void each_cell(const RasterRect& r, const RasterWindow& window, int columns, int rows, const Visit& visit) {
    const auto cell = [](double px, int begin, int count) {
        return static_cast<int>(
            std::clamp(std::floor((px - begin) / OneSurface::edge), -1.0, static_cast<double>(count)));
    };
    // `r` contains all positions at which some lens point sees the surface. Its light may reach one pixel
    // farther, because the pixel filter and the blur kernels extend that far.
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

OneSurfaceFinder::OneSurfaceFinder(const glm::dvec2& lens_px, double inverse_focus_per_m,
                                   const RasterWindow& window)
    : lens_px_(lens_px),
      inverse_focus_per_m_(inverse_focus_per_m),
      window_(window),
      columns_((window.width() + OneSurface::edge - 1) / OneSurface::edge),
      rows_((window.height() + OneSurface::edge - 1) / OneSurface::edge),
      owner_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), nobody),
      recorded_(owner_.size(), 0) {}

void OneSurfaceFinder::add(const PatchMesh& primary, const PatchMesh& deeper) {
    for (const PatchMesh* mesh : {&primary, &deeper}) {
        for (const Patch& p : mesh->patches) {
            RasterRect swept;
            PatchPlace place;
            double stretch = 0;
            for (int k = 0; k < 4; ++k) {
                const glm::dvec2 q((k & 1) != 0 ? lens_px_.x : -lens_px_.x,
                                   (k & 2) != 0 ? lens_px_.y : -lens_px_.y);
                if (!place_patch(*mesh, p, {}, {q, inverse_focus_per_m_, {}}, place)) continue;
                swept.add(covered(p, place));
                const glm::dmat2 d = place.move - glm::dmat2(1);
                stretch = std::max(
                    {stretch, std::abs(d[0].x), std::abs(d[0].y), std::abs(d[1].x), std::abs(d[1].y)});
            }
            const Sheet& s = mesh->sheet(p);
            const std::uint32_t id = mesh == &deeper || stretch > most_stretch ? several : s.key.id;
            each_cell(swept, window_, columns_, rows_, [&](std::size_t c) {
                if (owner_[c] == nobody) owner_[c] = id;
                if (owner_[c] != id) owner_[c] = several;
            });
            if (mesh == &deeper) continue;
            // Counts, in each cell of the image (8 x 8 px), the recorded pixels of directly visible surfaces.
            // If two parts of a surface overlap in a pixel, this pixel counts twice. So if the count of a
            // cell with only one surface exceeds 64, the surface overlaps itself there.
            const glm::dvec2 corner = mesh->corner(p);
            for (int y = 0; y < p.height; ++y) {
                for (int x = 0; x < p.width; ++x) {
                    const int i = static_cast<int>(corner.x) + x - window_.x_begin,
                              j = static_cast<int>(corner.y) + y - window_.y_begin;
                    if (i < 0 || j < 0 || i >= window_.width() || j >= window_.height()) continue;
                    const std::size_t cell =
                        s.first_cell + static_cast<std::size_t>(p.y + y) * static_cast<std::size_t>(s.width) +
                        static_cast<std::size_t>(p.x + x);
                    if (mesh->sheets->fine[cell] == SheetNode::none) continue;
                    ++recorded_[static_cast<std::size_t>(j / OneSurface::edge) *
                                    static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(i / OneSurface::edge)];
                }
            }
        }
    }
}

OneSurface OneSurfaceFinder::found() const {
    OneSurface out;
    out.columns = columns_;
    out.rows = rows_;
    out.cells.resize(owner_.size());
    for (std::size_t c = 0; c < owner_.size(); ++c) {
        const bool one = owner_[c] != nobody && owner_[c] != several;
        out.cells[c] = one && recorded_[c] <= OneSurface::edge * OneSurface::edge ? 1 : 0;
    }
    return out;
}

}  // namespace postlens
