// Random content of sample files: quadtrees of any depth, shading trees and hidden layers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "core/floor_div.h"
#include "records/record.h"
#include "records/sample_header.h"

namespace postlens::test {

/// Positions (y, x) in 1/1024 px. A set of them is in scanline order.
using Places = std::set<std::pair<int, int>>;
inline constexpr int steps_per_px = 1024;

/// Adds the corners of a square cell.
inline void add_corners(Places& places, int x, int y, int size) {
    for (const int dy : {0, size}) {
        for (const int dx : {0, size}) places.insert({y + dy, x + dx});
    }
}

/// Subdivides a cell with the given probability, and its quarters recursively up to `levels`.
inline void subdivide(Places& places, std::mt19937& random, double probability, int levels, int x, int y,
                      int size) {
    add_corners(places, x, y, size);
    if (levels == 0 || !std::bernoulli_distribution(probability)(random)) return;
    const int half = size / 2;
    for (const int dy : {0, half}) {
        for (const int dx : {0, half})
            subdivide(places, random, probability, levels - 1, x + dx, y + dy, half);
    }
}

/// What the records hold.
struct RandomOptions {
    int levels = 0;
    double probability = 0.5;  ///< that a cell is subdivided
    bool has_w = false;
    bool has_layers = false;
    bool has_bend = false;
    bool has_marks = false;
    int keys = 0;  ///< key instants besides the first
};

/// Random records of columns [x_begin, x_end) and rows [y_begin, y_end). The last column and the last row
/// have corner samples only.
inline RecordBand random_band(std::mt19937& random, int x_begin, int x_end, int y_begin, int y_end,
                              const RandomOptions& options) {
    Places places;
    for (int y = y_begin; y < y_end; ++y) {
        for (int x = x_begin; x < x_end; ++x) {
            places.insert({y * steps_per_px, x * steps_per_px});
            if (x + 1 < x_end && y + 1 < y_end) {
                subdivide(places, random, options.probability, options.levels, x * steps_per_px,
                          y * steps_per_px, steps_per_px);
            }
        }
    }
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<std::vector<Record>> pixels(static_cast<std::size_t>((x_end - x_begin) * (y_end - y_begin)));
    for (const auto& [place_y, place_x] : places) {
        const int px = floor_div(place_x, steps_per_px);
        const int py = floor_div(place_y, steps_per_px);
        auto& pixel = pixels[static_cast<std::size_t>((py - y_begin) * (x_end - x_begin) + px - x_begin)];
        Record r;
        r.x = static_cast<float>(place_x) / steps_per_px;
        r.y = static_cast<float>(place_y) / steps_per_px;
        const auto add = [&](NodePath path, std::uint32_t layer) {
            r.z =
                uniform(random) < 0.1F ? std::numeric_limits<float>::infinity() : 0.5F + 10 * uniform(random);
            r.r = uniform(random);
            r.g = 4 * uniform(random);
            r.b = uniform(random) < 0.3F ? 0 : 1e-3F * uniform(random);
            r.id = static_cast<std::uint32_t>(random());
            r.path = path;
            r.layer = layer;
            // Values that a half float stores exactly.
            if (options.has_bend)
                r.w_bend = uniform(random) < 0.2F ? std::numeric_limits<float>::infinity()
                                                  : static_cast<float>(random() % 2048) / 64;
            if (options.has_marks) r.mark = static_cast<std::uint8_t>(random() % 2);
            r.w = options.has_w
                      ? Mat2{uniform(random), uniform(random) - 1, uniform(random), -uniform(random)}
                      : Mat2::isotropic(1.0F / r.z);
            pixel.push_back(r);
        };
        add(NodePath(), 0);
        if (options.has_w && uniform(random) < 0.4F) {
            const NodePath reflected = NodePath().child(NodePath::Bounce::reflected);
            add(reflected, 0);
            add(reflected.child(NodePath::Bounce::transmitted), 0);
        }
        if (options.has_layers && uniform(random) < 0.4F) add(NodePath(), 1 + random() % 3);
    }
    RecordBand band;
    band.x_begin = x_begin;
    band.x_end = x_end;
    band.y_begin = y_begin;
    band.y_end = y_end;
    for (auto& pixel : pixels) {
        std::sort(pixel.begin(), pixel.end(), [](const Record& a, const Record& b) {
            return std::tuple(a.layer, a.y, a.x, a.path.bits()) <
                   std::tuple(b.layer, b.y, b.x, b.path.bits());
        });
        band.records.insert(band.records.end(), pixel.begin(), pixel.end());
        band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
    }
    return band;
}

/// A header for `random_frame`, with a different value in each field.
inline SampleHeader full_header(int width, int height, int overscan_px, const RandomOptions& options) {
    SampleHeader h;
    h.width = width;
    h.height = height;
    h.overscan_px = overscan_px;
    h.film_distance_mm = 50.1;
    h.pixel_pitch_mm = 0.036 / 3;
    h.focal_length_mm = 49.7;
    h.f_number = 2.8;
    h.focus_m = std::numeric_limits<double>::infinity();
    h.exposure_s = 1.0 / 48;
    h.world_from_camera = glm::dmat4(0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0.1, 0.2, 0.3, 1);
    h.time_s = 0.125;
    h.subdivide_levels = options.levels;
    h.subdivide_threshold = 0.05;
    h.max_depth = 5;
    h.min_contribution = 1.0 / 256;
    h.scene_name = "two spheres, \"quoted\"";
    h.scene_sha256 = std::string(64, 'a');
    h.metres_per_unit = 0.01;
    h.object_names = {{1, "floor"}, {7, "mirror ball"}, {4000000000U, "lamp"}};
    h.moving_ids = {7, 4000000000U};
    h.lights_move = true;
    h.motion.objects[7] = {{{.time_s = 0}, {.time_s = 0.1, .translation = {1.0 / 3, 0, -2}}}, {0, 0, 1}, 0.7};
    h.motion.camera = {{.time_s = 0.05, .rotation = {0.6, 0, 0.8, 0}}};
    h.motion.lights = {{.directional = true, .place = {0, 0.6, -0.8}},
                       {.place = {1, 2, 3}, .casts_shadows = false, .keys = {{.time_s = -1}}}};
    h.has_w = options.has_w;
    h.has_layers = options.has_layers;
    h.has_bend = options.has_bend;
    h.has_marks = options.has_marks;
    h.sufficient = {1.4, 0.8, std::numeric_limits<double>::infinity(), 0.1, 0.15};
    for (int k = 0; k < options.keys; ++k) h.key_times_s.push_back(0.1 + 0.05 * k + 1e-3);
    return h;
}

/// Random records of a whole file with this header.
inline RecordBand random_frame(std::mt19937& random, const SampleHeader& h, const RandomOptions& options) {
    return random_band(random, -h.overscan_px, h.width + h.overscan_px + 1, -h.overscan_px,
                       h.height + h.overscan_px + 1, options);
}

/// Rows [y_begin, y_end) of a band as a separate band.
inline RecordBand rows_of_band(const RecordBand& band, int y_begin, int y_end) {
    RecordBand out;
    out.x_begin = band.x_begin;
    out.x_end = band.x_end;
    out.y_begin = y_begin;
    out.y_end = y_end;
    const std::size_t first = band.pixel(band.x_begin, y_begin);
    const std::size_t last =
        first + static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(band.width());
    const std::uint32_t base = band.offsets[first];
    for (std::size_t k = first + 1; k <= last; ++k) out.offsets.push_back(band.offsets[k] - base);
    out.records.assign(band.records.begin() + base, band.records.begin() + band.offsets[last]);
    return out;
}

}  // namespace postlens::test
