#include <algorithm>
#include <cmath>

#include "core/checksum.h"
#include "core/error.h"
#include "pictures/exposure.h"
#include "records/file/sample_file_header.h"

namespace postlens {
namespace {

/// Collects the bytes of the header's checksum. docs/sample_file.md lists their order.
class HeaderBytes {
  public:
    template <typename T>
    void number(T value) {
        const auto* bytes = reinterpret_cast<const char*>(&value);
        bytes_.append(bytes, sizeof value);
    }
    void optional(const std::optional<double>& value) {
        number<std::uint8_t>(value ? 1 : 0);
        if (value) number(*value);
    }
    void text(const std::string& value) {
        number(static_cast<std::uint32_t>(value.size()));
        bytes_ += value;
    }
    [[nodiscard]] std::string checksum() const {
        return checksum_text(checksum_of(bytes_.data(), bytes_.size()));
    }

  private:
    std::string bytes_;
};

}  // namespace

std::string header_checksum(const SampleHeader& h) {
    HeaderBytes bytes;
    for (const int v : {h.version, h.width, h.height, h.overscan_px, static_cast<int>(h.projection)})
        bytes.number(v);
    for (const double v : {h.film_distance_mm, h.pixel_pitch_mm, h.focal_length_mm}) bytes.number(v);
    for (const auto& v : {h.f_number, h.focus_m, h.exposure_s}) bytes.optional(v);
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) bytes.number(h.world_from_camera[column][row]);
    }
    bytes.number(h.time_s);
    bytes.number(h.subdivide_levels);
    bytes.number(h.subdivide_threshold);
    bytes.number(h.max_depth);
    bytes.number(h.min_contribution);
    bytes.text(h.scene_name);
    bytes.text(h.scene_sha256);
    bytes.number(static_cast<std::uint32_t>(h.object_names.size()));
    for (const auto& [id, name] : h.object_names) {
        bytes.number(id);
        bytes.text(name);
    }
    bytes.number(static_cast<std::uint32_t>(h.moving_ids.size()));
    for (const std::uint32_t id : h.moving_ids) bytes.number(id);
    for (const bool v : {h.lights_move, h.has_w, h.has_layers}) bytes.number<std::uint8_t>(v ? 1 : 0);
    bytes.text(motion_text(h.motion));
    bytes.optional(h.sufficient.smallest_f_number);
    bytes.optional(h.sufficient.nearest_focus_m);
    bytes.optional(h.sufficient.farthest_focus_m);
    bytes.number(static_cast<std::uint32_t>(h.key_times_s.size()));
    for (const double v : h.key_times_s) bytes.number(v);
    bytes.optional(h.sufficient.shutter_open_s);
    bytes.optional(h.sufficient.shutter_close_s);
    // Fields added in later versions enter the checksum only if they are present, so that the checksums of
    // older files remain valid.
    if (h.has_bend) bytes.number<std::uint8_t>(1);
    const auto later = [&bytes](std::uint8_t tag, const std::optional<double>& value) {
        if (!value) return;
        bytes.number(tag);
        bytes.number(*value);
    };
    later(2, h.exposure_stops != 0 ? std::optional(h.exposure_stops) : std::nullopt);
    later(3, h.auto_exposure_stops);
    later(4, h.lumens_per_watt);
    if (h.has_marks) bytes.number<std::uint8_t>(5);
    if (!h.made_by.empty()) {
        bytes.number<std::uint8_t>(6);
        bytes.text(h.made_by);
    }
    later(7, h.metres_per_unit);
    return bytes.checksum();
}

namespace {

template <typename Demand>
void check_instants(const SampleHeader& h, const Demand& demand) {
    demand(std::isfinite(h.time_s), "frame time in s", h.time_s, "a finite number");
    demand(h.key_times_s.size() <= SampleHeader::most_keys, "number of key instants", h.key_times_s.size(),
           "at most 64");
    for (std::size_t i = 0; i < h.key_times_s.size(); ++i) {
        const double t = h.key_times_s[i];
        demand(std::isfinite(t), "key instant in s", t, "a finite number");
        demand(t != h.time_s, "key instant in s", t, "another than the frame's");
        demand(i == 0 || t > h.key_times_s[i - 1], "key instant in s", t, "growing instants");
    }
    const auto &open = h.sufficient.shutter_open_s, &close = h.sufficient.shutter_close_s;
    demand(open.has_value() == close.has_value(), "sufficient shutter", "half of one", "open and close");
    if (!open || !close) return;
    demand(std::isfinite(*open), "sufficient shutter opening in s", *open, "a finite number");
    demand(std::isfinite(*close) && *close >= *open, "sufficient shutter closing in s", *close,
           "a finite number not before the opening");
}

}  // namespace

void check_sample_header(const SampleHeader& h, const std::string& file) {
    const auto demand = [&](bool ok, const char* what, const auto& got, const char* expected) {
        if (!ok)
            fail(ExitCode::invalid_input, "{}: header: bad {} (got {}; expected {})", file, what, got,
                 expected);
    };
    const auto demand_positive = [&](const std::optional<double>& value, const char* what) {
        if (value) demand(*value > 0, what, *value, "greater than 0");
    };
    demand(h.version == SampleHeader::current_version, "format version", h.version, "2");
    demand(h.width > 0 && h.width <= largest_extent_px, "width", h.width, "1 to 262144");
    demand(h.height > 0 && h.height <= largest_extent_px, "height", h.height, "1 to 262144");
    demand(h.overscan_px >= 0 && h.overscan_px <= largest_extent_px, "overscan", h.overscan_px,
           "0 to 262144");
    demand(h.subdivide_levels >= 0 && h.subdivide_levels <= 10, "subdivision levels", h.subdivide_levels,
           "0 to 10");
    // Limits the size of the raster so that positions in it are exact. Positions are stored as floats with 24
    // significant bits. These bits must hold the index of the pixel and the position inside the pixel, which
    // needs one bit per level of subdivision.
    const int extent = std::max(h.width, h.height) + h.overscan_px + 1;
    demand(extent <= std::min(largest_extent_px, 1 << (24 - h.subdivide_levels)), "size with overscan",
           extent, "at most 2^(24 - subdivision levels) and 262144");
    demand(std::isfinite(h.pixel_pitch_mm) && h.pixel_pitch_mm > 0, "pixel pitch in mm", h.pixel_pitch_mm,
           "greater than 0");
    const bool perspective = h.projection == Projection::perspective;
    demand(
        std::isfinite(h.film_distance_mm) && (perspective ? h.film_distance_mm > 0 : h.film_distance_mm >= 0),
        "film distance in mm", h.film_distance_mm, "greater than 0");
    demand(std::isfinite(h.focal_length_mm) && h.focal_length_mm >= 0, "focal length in mm",
           h.focal_length_mm, "0 or more");
    demand_positive(h.f_number, "f-number");
    demand_positive(h.focus_m, "focus distance in m");
    demand_positive(h.sufficient.smallest_f_number, "smallest sufficient f-number");
    demand_positive(h.sufficient.nearest_focus_m, "nearest sufficient focus distance in m");
    demand_positive(h.sufficient.farthest_focus_m, "farthest sufficient focus distance in m");
    if (h.exposure_s) {
        demand(std::isfinite(*h.exposure_s) && *h.exposure_s >= 0, "exposure in s", *h.exposure_s,
               "0 or more");
    }
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            const double v = h.world_from_camera[column][row];
            demand(std::isfinite(v), "camera matrix", v, "finite numbers");
        }
    }
    const double determinant = glm::determinant(h.world_from_camera);
    demand(std::isfinite(determinant) && determinant != 0, "camera matrix", "a singular one",
           "one to invert");
    check_instants(h, demand);
    demand(std::isfinite(h.subdivide_threshold) && h.subdivide_threshold >= 0, "subdivision threshold",
           h.subdivide_threshold, "0 or more");
    demand(h.max_depth >= 0 && h.max_depth <= NodePath::max_bounces + 1, "depth of the shading tree",
           h.max_depth, "0 to 17");
    demand(std::isfinite(h.min_contribution) && h.min_contribution >= 0, "smallest contribution",
           h.min_contribution, "0 or more");
    const auto demand_stops = [&](double stops, const char* what) {
        demand(std::abs(stops) <= most_exposure_stops, what, stops, "-100 to 100");
    };
    demand_stops(h.exposure_stops, "exposure in stops");
    if (h.auto_exposure_stops) demand_stops(*h.auto_exposure_stops, "exposure by auto in stops");
    if (h.lumens_per_watt) {
        demand(std::isfinite(*h.lumens_per_watt) && *h.lumens_per_watt > 0, "lumens per watt",
               *h.lumens_per_watt, "greater than 0");
    }
    if (h.metres_per_unit) {
        demand(std::isfinite(*h.metres_per_unit) && *h.metres_per_unit > 0, "metres per unit",
               *h.metres_per_unit, "greater than 0");
    }
    demand(!h.has_bend || h.has_w, "W.bend", "it alone", "the channels of W as well");
    demand(!h.object_names.contains(0), "object name", "one for id 0", "none, as 0 is nothing");
}

}  // namespace postlens