#include "planner/predicted_error.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "focus/lens_views.h"
#include "planner/pilot.h"
#include "planner/record_floor.h"
#include "records/crop.h"
#include "records/srgb.h"

namespace postlens {
namespace {

/// Where the noise of the views is all that has to be known, and where they are what is compared with. Sets
/// of their own, so that what happens to be alike in the picture's views is not in theirs.
constexpr int views_for_noise = 8, views_to_compare = 32, first_set = 3;

double product_of_errors(const Image& image, const Pilot& pilot, std::size_t k) {
    double sum = 0;
    const auto encoded = [](const Image& of, std::size_t c) {
        return static_cast<double>(srgb_from_linear(of.rgb[c]));
    };
    for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
        const double value = encoded(image, c);
        sum += (value - encoded(pilot.a, c)) * (value - encoded(pilot.b, c)) / 3;
    }
    return sum;
}

}  // namespace

void check_predictable(const SampleHeader& h, const FocusSettings& focus) {
    if (focus.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments,
             "--predict: not with another framing than the trace's (expected --framing keep)");
    }
    if (h.projection != Projection::perspective)
        fail(ExitCode::wrong_arguments,
             "--predict: not of an orthographic file (expected a perspective one)");
    check_impulse(focus.impulse);
    if (!has_points(focus.impulse)) {
        fail(ExitCode::wrong_arguments,
             "--predict: looks at the records from points of a thin lens (got --impulse {}; expected disc, "
             "polygon or image)",
             impulse_text(focus.impulse));
    }
    check_crop(focus.crop, h.width, h.height);
}

PredictedError predict_error(FocusFrame& frame, const HybridSettings& lens, const MadeOfRecords& made) {
    const SampleHeader& h = frame.file().header();
    check_predictable(h, lens.focus);
    const bool by_views = made.method == FocusMethod::lightfield || made.method == FocusMethod::hybrid;
    const int views = by_views ? views_for_noise : views_to_compare;
    const Pilot pilot(frame, lens, views, first_set);
    const double noise_share = by_views ? noise_of_set(views, made.views) : 0;

    PredictedError out{{h.width, h.height}, {}, 0, 2 * views};
    out.tiles.resize(out.grid.count());
    std::vector<int> pixels(out.tiles.size());
    const Crop asked = lens.focus.crop.value_or(Crop{0, 0, h.width, h.height});
    for (int y = asked.y; y < asked.y + asked.height; ++y) {
        for (int x = asked.x; x < asked.x + asked.width; ++x) {
            const std::size_t k = static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width) +
                                  static_cast<std::size_t>(x),
                              t = out.grid.at(x, y);
            PredictedTile& to = out.tiles[t];
            ++pixels[t];
            const std::uint8_t what = made.what.empty() ? 0 : made.what[k];
            if (what == 2) {  // traced again
                to.floor_mse +=
                    floor_unseen * (still_unseen * static_cast<double>(pilot.floor[k] - pilot.spread[k]) +
                                    static_cast<double>(pilot.spread[k]));
                continue;
            }
            if (!by_views)
                to.method_mse += product_of_errors(*made.image, pilot, k);
            else if (what == 0)
                to.method_mse += noise_share * static_cast<double>(pilot.noise[k]);
            to.floor_mse += floor_unseen * static_cast<double>(pilot.floor[k]);
            to.hidden_mse += static_cast<double>(pilot.hidden[k]);
        }
    }
    PredictedTile all;
    for (std::size_t t = 0; t < out.tiles.size(); ++t) {
        PredictedTile& tile = out.tiles[t];
        all.method_mse += tile.method_mse;
        all.floor_mse += tile.floor_mse;
        all.hidden_mse += tile.hidden_mse;
        const double count = std::max(1, pixels[t]);
        tile = {std::max(0.0, tile.method_mse / count), tile.floor_mse / count, tile.hidden_mse / count};
    }
    const double count = static_cast<double>(asked.width) * asked.height;
    all = {std::max(0.0, all.method_mse / count), all.floor_mse / count, all.hidden_mse / count};
    out.predicted_db = -10 * std::log10(std::max(all.mse(), 1e-12));
    return out;
}

}  // namespace postlens
