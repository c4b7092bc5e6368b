// Records for the tests of focus/, made by functions of the pixel, and their images by the scatter method.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "focus/scatter/scatter.h"
#include "focus/scatter/splat_tables.h"
#include "records/record.h"

namespace postlens::test {

/// A primary node of object 1 at depth z_m.
inline Record corner(double z_m, float r, float g, float b) {
    Record out;
    out.z = static_cast<float>(z_m);
    out.r = r;
    out.g = g;
    out.b = b;
    out.id = 1;
    out.w = Mat2::isotropic(1 / out.z);
    return out;
}

/// Returns the nodes of the sample at corner (x, y), the primary node first. The caller sets their x and y.
using NodesAt = std::function<std::vector<Record>(int x, int y)>;

/// The corner samples of the pixels [-overscan_px, width + overscan_px) x [-overscan_px, height +
/// overscan_px).
inline RecordBand corner_band(int width, int height, int overscan_px, const NodesAt& nodes_at) {
    RecordBand band;
    band.x_begin = band.y_begin = -overscan_px;
    band.x_end = width + overscan_px + 1;
    band.y_end = height + overscan_px + 1;
    for (int y = band.y_begin; y < band.y_end; ++y) {
        for (int x = band.x_begin; x < band.x_end; ++x) {
            for (Record r : nodes_at(x, y)) {
                r.x = static_cast<float>(x);
                r.y = static_cast<float>(y);
                band.records.push_back(r);
            }
            band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
        }
    }
    return band;
}

/// Subdivides pixel (x, y) once: adds samples at its centre and at the middles of its sides. The middles of
/// the right and the lower side are stored with the neighbouring pixels, which must exist.
inline void subdivide_pixel(RecordBand& band, int x, int y,
                            const std::function<Record(float x, float y)>& record_at) {
    const auto insert = [&](float px, float py) {
        const std::size_t k = band.pixel(static_cast<int>(std::floor(px)), static_cast<int>(std::floor(py)));
        Record r = record_at(px, py);
        r.x = px;
        r.y = py;
        const auto begin = band.records.begin() + band.offsets[k];
        const auto end = band.records.begin() + band.offsets[k + 1];
        const auto before = [](const Record& a, const Record& b) {
            return a.y != b.y ? a.y < b.y : a.x < b.x;
        };
        const auto at = std::lower_bound(begin, end, r, before);
        if (at != end && at->x == px && at->y == py) return;
        band.records.insert(at, r);
        for (std::size_t i = k + 1; i < band.offsets.size(); ++i) ++band.offsets[i];
    };
    const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
    insert(fx + 0.5F, fy + 0.5F);
    insert(fx + 0.5F, fy);
    insert(fx, fy + 0.5F);
    insert(fx + 1, fy + 0.5F);
    insert(fx + 0.5F, fy + 1);
}

/// A lens that is focused at infinity, with a CoC of radius 1 px m / z: the depth of 1/r m has a radius of r
/// px.
constexpr FocusGeometry unit_geometry{
    .aperture_radius_m = 1e-3, .inverse_focus_per_m = 0, .gain_px = 1000, .zoom = 1};

/// A lens of 50 mm at f/1.4, focused at 5 m, for 960 px on a film of 36 mm.
constexpr FocusGeometry lens_geometry{
    .aperture_radius_m = 0.0179, .inverse_focus_per_m = 0.2, .gain_px = 1333, .zoom = 1};

/// The nearest and the farthest finite depth of a band.
inline DepthRange range_of(const RecordBand& band) {
    DepthRange out;
    for (const Record& r : band.records) {
        if (std::isinf(r.z)) continue;
        const double z_m = r.z;
        out.nearest_m = std::min(out.nearest_m.value_or(z_m), z_m);
        out.farthest_m = std::max(out.farthest_m.value_or(z_m), z_m);
    }
    return out;
}

/// What `tables_of` needs besides the band.
struct TableOptions {
    FocusGeometry geometry = unit_geometry;
    DepthSpacing spacing = DepthSpacing::inverse;
    std::optional<int> depths;
    DepthModel model = DepthModel::ray_differentials;
};

/// The splats of a whole band, for the pixels without its overscan.
inline std::unique_ptr<SplatTables> tables_of(const RecordBand& band, int overscan_px,
                                              const TableOptions& o = {},
                                              std::shared_ptr<const ResponseModel> response = nullptr) {
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end};
    const RasterWindow picture{band.x_begin + overscan_px, band.x_end - overscan_px - 1,
                               band.y_begin + overscan_px, band.y_end - overscan_px - 1};
    auto tables = std::make_unique<SplatTables>(source, picture, o.geometry,
                                                DepthLevels(o.geometry, range_of(band), o.spacing, o.depths),
                                                o.model, std::move(response));
    tables->add_rows(band, band.y_begin, band.y_end);
    tables->finish();
    return tables;
}

/// The image of a band by the scatter method.
inline Image scattered(const RecordBand& band, int overscan_px, const TableOptions& options = {}) {
    Image image;
    scatter(*tables_of(band, overscan_px, options), image);
    return image;
}

inline double value(const Image& image, int x, int y, int channel) {
    return static_cast<double>(image.pixel(x, y)[channel]);
}

/// The largest absolute difference of two values; infinite for images of different sizes.
inline double difference(const Image& a, const Image& b) {
    double most = a.width == b.width && a.height == b.height ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(a.rgb.size(), b.rgb.size()); ++i) {
        most = std::max(most, std::abs(static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i])));
    }
    return most;
}

}  // namespace postlens::test
