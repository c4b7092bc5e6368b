// What a compositor does to single objects before the lens: holdouts, sharp objects, moved focus.
#pragma once

#include <vector>

#include "records/foreign_picture.h"
#include "records/object_choice.h"

namespace postlens {

struct ObjectEffects {
    /// Hide what is behind them, sharply, and are not in the image: neither their colour nor their alpha.
    std::vector<ObjectChoice> holdouts;
    /// Are not blurred.
    std::vector<ObjectChoice> sharp;
    /// Are blurred as if they were so much farther away, m; what they hide stays.
    struct Offset {
        ObjectChoice object;
        double metres = 0;
    };
    std::vector<Offset> offsets;
};

/// Changes the samples of a picture. What an object hides is decided by its own depth in every case. An
/// offset that would move an object to the camera or behind it leaves it at a millimetre. Throws as
/// `choose_samples`.
void apply_object_effects(ForeignPicture& picture, const ObjectEffects& effects, double inverse_focus_per_m);

}  // namespace postlens
