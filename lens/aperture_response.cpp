#include "lens/aperture_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lens/cell_deposit.h"

namespace postlens {
namespace {

using glm::dmat2;
using glm::dvec2;

dvec2 image_of(const ApertureImage& image, const dmat2& map, const dvec2& q) {
    return image.centre_px + map * q + image.spherical_px * glm::dot(q, q) * q;
}

/// Largest singular value of the map.
double stretch(const dmat2& m) {
    const double xx = glm::dot(m[0], m[0]), yy = glm::dot(m[1], m[1]), xy = glm::dot(m[0], m[1]);
    return std::sqrt((xx + yy) / 2 + std::hypot((xx - yy) / 2, xy));
}

ResponseGrid grid_for(const ApertureImage& image, double reach_px, const PixelWindow& window) {
    const auto begin = [](double centre, double reach, int low, int high) {
        return static_cast<int>(
            std::clamp(std::floor(centre - reach), static_cast<double>(low), static_cast<double>(high)));
    };
    const auto end = [](double centre, double reach, int low, int high) {
        return static_cast<int>(
            std::clamp(std::ceil(centre + reach), static_cast<double>(low), static_cast<double>(high)));
    };
    // Enlarges the radius of the blur kernel slightly. Otherwise, rounding might cut off a corner of the
    // kernel that lies exactly on a pixel border.
    const double reach = reach_px * (1 + 1e-9) + 1e-9;
    const int x_begin = begin(image.centre_px.x, reach, window.x_begin, window.x_end),
              x_end = end(image.centre_px.x, reach, x_begin, window.x_end),
              y_begin = begin(image.centre_px.y, reach, window.y_begin, window.y_end),
              y_end = end(image.centre_px.y, reach, y_begin, window.y_end);
    return {x_begin, y_begin, x_end - x_begin, y_end - y_begin};
}

/// Returns into how many parts a straight line on the lens, `length` lens radii long, must be divided.
/// Spherical aberration (`spherical_px`) bends the line's image on the film, but the image of each part must
/// be straight within 0.02 px.
int parts_of(double length, double spherical_px) {
    constexpr double within_px = 0.02, most = 256;
    const double longest = std::sqrt(8 * within_px / (6 * std::sqrt(2.0) * std::abs(spherical_px)));
    return static_cast<int>(std::clamp(std::ceil(length / longest), 1.0, most));
}

/// An aperture image at reduced resolution. Each value is the sum of `step` x `step` original cells.
struct CoarsePicture {
    int step = 1, width = 0, height = 0;
    std::vector<double> light;
};

/// Reduces the resolution of an image of the aperture. In the blur kernel, each cell of this image is
/// `cell_px` px wide. Neighbouring cells are combined into larger ones, about half a pixel wide, because
/// smaller cells would only take more time.
CoarsePicture coarse_enough(const AperturePicture& from, double cell_px) {
    const int longest = std::max(from.width, from.height);
    const int step =
        static_cast<int>(std::clamp(0.5 / std::max(cell_px, 1e-12), 1.0, static_cast<double>(longest)));
    CoarsePicture out{step, (from.width + step - 1) / step, (from.height + step - 1) / step, {}};
    out.light.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), 0);
    for (int y = 0; y < from.height; ++y) {
        for (int x = 0; x < from.width; ++x) {
            out.light[static_cast<std::size_t>(y / step) * static_cast<std::size_t>(out.width) +
                      static_cast<std::size_t>(x / step)] +=
                from.light[static_cast<std::size_t>(y) * static_cast<std::size_t>(from.width) +
                           static_cast<std::size_t>(x)];
        }
    }
    return out;
}

/// Adds the blur kernel of an aperture that is given as an image to a grid of pixels (`deposit`). Returns the
/// energy that was added.
double deposit_picture(const Aperture& aperture, const ApertureImage& image, const dmat2& map, double scale,
                       CellDeposit& deposit) {
    const AperturePicture& whole = *aperture.picture();
    const double cell = 2.0 / std::max(whole.width, whole.height);
    const double narrower = aperture.half_extent().x / (whole.width * cell / 2);
    const CoarsePicture p = coarse_enough(whole, cell * scale * std::max(1.0, narrower));
    const auto corner = [&](int x, int y) {
        return dvec2((std::min(x * p.step, whole.width) - whole.width / 2.0) * cell * narrower,
                     (std::min(y * p.step, whole.height) - whole.height / 2.0) * cell);
    };
    const auto light = [&p](int x, int y) {
        return p.light[static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                       static_cast<std::size_t>(x)];
    };
    const Outline second =
        aperture.varies_over_field() ? aperture.second_rim(image.field, 1e-3, image.rim_scale) : Outline();
    double sum = 0;
    for (int y = 0; y < p.height; ++y) {
        for (int x = 0; x < p.width; ++x) {
            if (light(x, y) == 0) continue;
            const dvec2 low = corner(x, y), size = corner(x + 1, y + 1) - low;
            const int parts = parts_of(std::max(size.x, size.y), image.spherical_px);
            for (int k = 0; k < parts * parts; ++k) {
                const dvec2 at = low + dvec2(k % parts, k / parts) * size / static_cast<double>(parts);
                const dvec2 end = at + size / static_cast<double>(parts);
                Outline part{at, dvec2(end.x, at.y), end, dvec2(at.x, end.y)};
                double energy = light(x, y) / (parts * parts);
                if (!second.empty() && !std::all_of(part.begin(), part.end(), [&](const dvec2& q) {
                        return aperture.passes(q, image.field, image.rim_scale);
                    })) {
                    const double all = area(part);
                    part = intersection(part, second);
                    if (part.empty()) continue;
                    energy *= area(part) / all;
                }
                for (dvec2& q : part) q = image_of(image, map, q);
                deposit.add(part, energy);
                sum += energy;
            }
        }
    }
    return sum;
}

/// Computes the blur kernel of an aperture that is given by its outline. Divides the aperture into rings
/// around its centre, and each ring into cells. The light of each cell is added to the pixels on which it
/// falls.
void deposit_rings(const Aperture& aperture, const ApertureImage& image, const dmat2& map, double scale,
                   CellDeposit& deposit) {
    constexpr double within_px = 0.02, ring_px = 1.5;
    const Outline corners =
        aperture.outline(image.field, std::clamp(within_px / scale, 1e-6, 5e-3), image.rim_scale);
    Outline rim;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const dvec2 side = corners[(i + 1) % corners.size()] - corners[i];
        const int parts = parts_of(glm::length(side), image.spherical_px);
        for (int k = 0; k < parts; ++k) rim.push_back(corners[i] + side * (static_cast<double>(k) / parts));
    }
    if (rim.empty()) return;
    dvec2 middle(0);
    for (const dvec2& p : rim) middle += p / static_cast<double>(rim.size());
    const double total = area(rim);
    const int rings = static_cast<int>(std::clamp(scale / ring_px, 24.0, 512.0));
    std::vector<dvec2> inner(rim.size(), image_of(image, map, middle)), outer(rim.size());
    for (int ring = 1; ring <= rings; ++ring) {
        const double t = static_cast<double>(ring) / rings, before = (ring - 1.0) / rings;
        for (std::size_t i = 0; i < rim.size(); ++i)
            outer[i] = image_of(image, map, middle + t * (rim[i] - middle));
        for (std::size_t i = 0; i < rim.size(); ++i) {
            const std::size_t next = (i + 1) % rim.size();
            const dvec2 a = rim[i] - middle, b = rim[next] - middle;
            const double energy = (a.x * b.y - a.y * b.x) / 2 / total * (t * t - before * before);
            // Splits each cell of the aperture into two triangles. The points `inner` and `outer`, at which
            // rays through the corners of a cell land on the film, may form a quadrilateral that crosses
            // itself. A triangle cannot cross itself.
            const double inner_share = before / (before + t);  // for the triangle with the inner side
            deposit.add(std::array<dvec2, 3>{inner[i], outer[i], outer[next]}, energy * (1 - inner_share));
            if (ring > 1)
                deposit.add(std::array<dvec2, 3>{inner[i], outer[next], inner[next]}, energy * inner_share);
        }
        std::swap(inner, outer);
    }
}

}  // namespace

dmat2 with_area(const dmat2& m) {
    const auto determinant = [](const dmat2& a) { return a[0].x * a[1].y - a[0].y * a[1].x; };
    const double largest = stretch(m);
    if (largest < smallest_response_px) {
        return dmat2(determinant(m) < 0 || m[0].x + m[1].y >= 0 ? smallest_response_px
                                                                : -smallest_response_px);
    }
    if (std::abs(determinant(m)) >= largest * smallest_response_px) return m;
    const dmat2 more = m + dmat2(smallest_response_px), less = m - dmat2(smallest_response_px);
    return std::abs(determinant(more)) >= std::abs(determinant(less)) ? more : less;
}

bool is_even(const Aperture& aperture, const ApertureImage& image) {
    return !aperture.picture() && image.spherical_px == 0;
}

double largest_reach_px(const Aperture& aperture, const ApertureImage& image) {
    const double farthest = aperture.farthest();
    return stretch(with_area(image.map_px)) * farthest +
           std::abs(image.spherical_px) * farthest * farthest * farthest;
}

double rim_of(const Aperture& aperture) {
    const dvec2 half = aperture.half_extent();
    return aperture.picture() ? aperture.farthest() : std::max(half.x, half.y);
}

double farthest_light_px(const Aperture& aperture, double radius_px, double spherical_px) {
    // Computes where rays land, relative to the ray through the lens centre. A ray that passes the lens at
    // rho lens radii from its centre lands |R rho + S rho^3| px away. R is the signed CoC radius `radius_px`,
    // and S is `spherical_px`, which describes spherical aberration.
    const double rim = rim_of(aperture), square = rim * rim;
    const double out = rim * std::abs(radius_px + spherical_px * square);
    // Usually, the ray through the rim of the lens lands farthest from the centre of the blur. But if defocus
    // and spherical aberration have opposite signs, a ray through a smaller radius, `zone`, may land farther
    // away.
    if (radius_px * spherical_px >= 0 || std::abs(radius_px) >= 3 * std::abs(spherical_px) * square)
        return out;
    // At this radius rho, the displacement |R rho + S rho^3| has a local maximum.
    const double zone = std::sqrt(-radius_px / (3 * spherical_px));
    return std::max(out, 2 * std::abs(radius_px) * zone / 3);
}

Outline image_outline(const Aperture& aperture, const ApertureImage& image) {
    const dmat2 map = with_area(image.map_px);
    // Maximum error of the outline of the blur kernel, in px. With cat's-eye vignetting, the outline changes
    // from pixel to pixel, but neighbouring pixels share one kernel. This causes a small error anyway, so
    // 0.02 px suffices.
    const double within_px = aperture.varies_over_field() ? 0.02 : 1e-3;
    Outline out = aperture.outline(image.field, std::min(within_px / stretch(map), 0.02), image.rim_scale);
    for (dvec2& p : out) p = image_of(image, map, p);
    return out;
}

ResponseGrid dense_response(const Aperture& aperture, const ApertureImage& image, const PixelWindow& window) {
    const dmat2 map = with_area(image.map_px);
    const double scale = stretch(map) + 3 * std::abs(image.spherical_px);
    ResponseGrid grid = grid_for(image, largest_reach_px(aperture, image), window);
    if (grid.share.empty()) return grid;
    CellDeposit deposit(grid);
    if (aperture.picture()) {
        const double sum = deposit_picture(aperture, image, map, scale, deposit);
        deposit.finish();
        for (double& share : grid.share) share /= std::max(sum, std::numeric_limits<double>::min());
    } else {
        deposit_rings(aperture, image, map, scale, deposit);
        deposit.finish();
    }
    return grid;
}

ResponseGrid ray_response(const Aperture& aperture, const ApertureImage& image, const PixelWindow& window,
                          int points) {
    ResponseGrid grid = grid_for(image, largest_reach_px(aperture, image), window);
    const dmat2 map = with_area(image.map_px);
    double passing = 0;
    for (int k = 0; k < points * points; ++k) {
        const int column = k % points, row = k / points;
        const dvec2 q = aperture.sample((column + 0.5) / points, (row + 0.5) / points);
        if (aperture.varies_over_field() && !aperture.passes(q, image.field, image.rim_scale)) continue;
        passing += 1;
        const dvec2 p = image_of(image, map, q);
        const double x = std::floor(p.x) - grid.x_begin, y = std::floor(p.y) - grid.y_begin;
        if (x >= 0 && y >= 0 && x < grid.width && y < grid.height)
            grid.at(static_cast<int>(x), static_cast<int>(y)) += 1;
    }
    for (double& share : grid.share) share /= std::max(passing, 1.0);
    return grid;
}

}  // namespace postlens
