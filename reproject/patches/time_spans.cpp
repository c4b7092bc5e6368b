#include "reproject/patches/time_spans.h"

#include <algorithm>
#include <array>

namespace postlens {

std::vector<TimeSpanViews> time_spans(const PatchField& field, std::size_t instant) {
    std::array<TimeSpanViews, 64> spans;
    std::vector<TimeSpanViews> out;
    const auto add = [&](const TimeSpanViews::ViewUse& at, bool timed) {
        if (!timed) {
            out.push_back({at, at});
            return;
        }
        const double light_before = at.view->light_before,
                     number = light_before * static_cast<double>(spans.size());
        TimeSpanViews& span =
            spans[static_cast<std::size_t>(std::clamp(number, 0.0, static_cast<double>(spans.size()) - 1))];
        if (span.first.view == nullptr || light_before < span.first.view->light_before) span.first = at;
        if (span.last.view == nullptr || light_before > span.last.view->light_before) span.last = at;
    };
    for (const PatchViews& set : field.sets) {
        for (const PatchView& view : set.views) {
            for (const PatchView::Use& use : view.uses) {
                if (use.instant == instant && !use.motions.empty()) add({&view, &use}, set.rays != nullptr);
            }
        }
    }
    std::copy_if(spans.begin(), spans.end(), std::back_inserter(out),
                 [](const TimeSpanViews& span) { return span.first.view != nullptr; });
    return out;
}

}  // namespace postlens
