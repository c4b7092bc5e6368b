#include "planner/predicted_error.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "focus/light_field/lens_views.h"
#include "pictures/crop.h"
#include "pictures/srgb.h"
#include "planner/errors/records_bound.h"
#include "planner/stated_error.h"
#include "planner/views/halved_views.h"

namespace postlens {
namespace {

/// To estimate the error of an image, at least `least_views` more views (images from different lens points)
/// are compared with it. `first_set` is the number of their first set of lens points. The image itself uses
/// sets with lower numbers, so its noise is independent of theirs.
constexpr int least_views = 64, first_set = 1 << 20;

double product_of_errors(const Image& image, const Image& a, const Image& b, std::size_t k) {
    double sum = 0;
    const auto encoded = [](const Image& of, std::size_t c) {
        return static_cast<double>(srgb_from_linear(of.rgb[c]));
    };
    for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
        const double value = encoded(image, c);
        sum += (value - encoded(a, c)) * (value - encoded(b, c)) / 3;
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

PredictedError predict_error(FocusFrame& frame, const HybridSettings& lens, const Image& image, int views) {
    const SampleHeader& h = frame.file().header();
    check_predictable(h, lens.focus);
    HybridSettings records = lens;
    records.scene = nullptr;
    HalvedViews halves(frame, records, first_set);
    const int count = std::clamp(views, least_views, most_lens_views);
    halves.draw(std::vector<int>(halves.grid().count(), count));
    const RecordsBound bound = records_bound(frame, records, image);
    PredictedError out{.grid = halves.grid(), .views = count};
    out.tiles.resize(out.grid.count());
    std::vector<int> pixels(out.tiles.size());
    const Crop asked = lens.focus.crop.value_or(Crop{0, 0, h.width, h.height});
    for (int y = asked.y; y < asked.y + asked.height; ++y) {
        for (int x = asked.x; x < asked.x + asked.width; ++x) {
            const std::size_t k = static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width) +
                                  static_cast<std::size_t>(x),
                              t = out.grid.at(x, y);
            ++pixels[t];
            out.tiles[t].method_mse +=
                product_of_errors(image, halves.half(0).image, halves.half(1).image, k);
            out.tiles[t].bound_mse += static_cast<double>(bound.mse[k]);
        }
    }
    PredictedTile all;
    for (std::size_t t = 0; t < out.tiles.size(); ++t) {
        PredictedTile& tile = out.tiles[t];
        all.method_mse += tile.method_mse;
        all.bound_mse += tile.bound_mse;
        const double in_tile = std::max(1, pixels[t]);
        tile = {std::max(0.0, tile.method_mse / in_tile), tile.bound_mse / in_tile};
    }
    const double in_all = static_cast<double>(asked.width) * asked.height,
                 method = std::max(0.0, all.method_mse / in_all);
    out.predicted_db = stated_db(method);
    out.bound_db = stated_db(together_mse(method, all.bound_mse / in_all));
    out.unsure_share = mean_of(bound.unsure, h.width, lens.focus.crop);
    return out;
}

}  // namespace postlens
