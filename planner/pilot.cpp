#include "planner/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/threads.h"
#include "planner/hidden_error.h"
#include "planner/record_floor.h"
#include "records/aperture_file.h"
#include "records/srgb.h"

namespace postlens {
namespace {

/// See noise_of_set.
constexpr double noise_exponent = 1.15;

FocusGeometry geometry_as_traced(const SampleHeader& h, const FocusSettings& focus) {
    return focus_geometry(focus.lens, focus.focus_distance_m, Framing::keep,
                          {h.film_distance_mm, h.pixel_pitch_mm});
}

std::vector<float> encoded(const Image& image) {
    std::vector<float> out(image.rgb.size());
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
        const std::size_t row = 3 * static_cast<std::size_t>(image.width);
        for (std::size_t i = y * row; i < (y + 1) * row; ++i) out[i] = srgb_from_linear(image.rgb[i]);
    });
    return out;
}

}  // namespace

Pilot::Pilot(FocusFrame& frame, const HybridSettings& lens, int views, int first_set)
    : geometry_(geometry_as_traced(frame.file().header(), lens.focus)),
      aperture_(read_aperture(lens.focus.impulse)) {
    const SampleHeader& h = frame.file().header();
    FieldFocusSettings by_field{geometry_, aperture_,      {0, h.width, 0, h.height}, views, {}, {},
                                {},        lens.focus.crop};
    if (lens.motion != nullptr && lens.shutter)
        by_field.shutter = {lens.motion, lens.shutter->open_s, lens.shutter->close_s, lens.curve};
    MisplacedLight misplaced(h, geometry_);
    RecordFloor record_floor(h, geometry_);
    by_field.also.rows = [&](const RecordBand& band, int y_begin, int y_end) {
        misplaced.add(band, y_begin, y_end);
    };
    by_field.also.leaves = record_floor.adds();
    focuser_ = std::make_unique<FieldFocuser>(frame, by_field);
    aligned = record_floor.aligned();
    spread = record_floor.spread();
    floor = std::move(record_floor).picture();

    const std::array<FieldViews, 2> sets{
        {{.count = views, .set = first_set}, {.count = views, .set = first_set + 1, .picture = 1}}};
    std::vector<FieldFocus> drawn = focuser_->draw(sets);
    const FieldFocus &one = drawn[0], &other = drawn[1];
    const std::vector<float> ea = encoded(one.image), eb = encoded(other.image);
    HiddenError hidden_error(one.image, misplaced,
                             apart_px(frame.file(), geometry_, lens.shutter.has_value()));
    hidden.resize(one.unknown.size());
    noise.resize(hidden.size());
    for (std::size_t k = 0; k < hidden.size(); ++k) {
        // Half the mean squared difference of two sets is the error of one.
        double square = 0;
        for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
            const double d = static_cast<double>(ea[c]) - static_cast<double>(eb[c]);
            square += d * d / 6;
        }
        noise[k] = static_cast<float>(square);
        const HiddenError::Shares u = HiddenError::shares(one, k), v = HiddenError::shares(other, k);
        hidden[k] = static_cast<float>(
            hidden_error.at(k, {(u.unknown + v.unknown) / 2, (u.unknown_below + v.unknown_below) / 2,
                                (u.guessed_below + v.guessed_below) / 2}));
    }
    light_square = std::move(drawn[0].light_square);
    a = std::move(drawn[0].image);
    b = std::move(drawn[1].image);
}

double noise_of_set(int pilot_views, int views) {
    return std::pow(static_cast<double>(pilot_views) / views, noise_exponent);
}

double noise_of_views(double pilot_mse, int pilot_views, int views) {
    if (views <= pilot_views) return pilot_mse;
    if (views <= 2 * pilot_views) return two_sets * pilot_mse;
    return pilot_mse / (1 / two_sets + 1 / noise_of_set(pilot_views, views - 2 * pilot_views));
}

}  // namespace postlens
