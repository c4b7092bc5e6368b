#include "focus/foreign/object_effects.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/text.h"

namespace postlens {
namespace {

template <typename Change>
void change(ForeignPicture& picture, const ObjectChoice& object, const Change& change_sample) {
    const std::vector<std::uint8_t> chosen = choose_samples(picture, object);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (chosen[i] != 0) change_sample(picture.samples[i]);
    }
}

}  // namespace

void apply_object_effects(ForeignPicture& picture, const ObjectEffects& effects, double inverse_focus_per_m) {
    const auto in_focus = static_cast<float>(inverse_focus_per_m);
    constexpr double nearest_m = 1e-3;
    for (const ObjectEffects::Offset& o : effects.offsets) {
        std::size_t moved = 0, behind = 0;
        change(picture, o.object, [&](StackSample& s) {
            if (s.inverse_z == 0) return;  // an infinitely far sample stays there
            const double z = 1 / static_cast<double>(s.inverse_z) + o.metres;
            s.moved_inverse_z = static_cast<float>(1 / std::max(z, nearest_m));
            ++moved;
            behind += z < nearest_m ? 1 : 0;
        });
        if (behind == 0) continue;
        const double share = static_cast<double>(behind) / static_cast<double>(moved);
        picture.repairs.push_back(
            {"offset",
             fmt::format(
                 "--focus-offset: {:g} m move {} % of {} behind the camera: blurred as if 1 mm before "
                 "it (expected a smaller offset)",
                 o.metres, rough(100 * share), o.object.object),
             share});
    }
    for (const ObjectChoice& o : effects.sharp)
        change(picture, o, [&](StackSample& s) { s.moved_inverse_z = in_focus; });
    for (const ObjectChoice& o : effects.holdouts) {
        change(picture, o, [&](StackSample& s) {
            s.moved_inverse_z = in_focus;
            s.holdout = true;
            s.r = s.g = s.b = 0;
        });
    }
}

}  // namespace postlens
