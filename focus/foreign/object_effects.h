// What a compositor does to single objects before the lens: holdouts, sharp objects, moved focus.
#pragma once

#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/object_choice.h"

namespace postlens {

struct ObjectEffects {
    /// Holdouts: objects that hide what is behind them, with sharp edges, but add neither colour nor alpha to
    /// the image.
    std::vector<ObjectChoice> holdouts;
    /// Objects that are not blurred.
    std::vector<ObjectChoice> sharp;
    /// Objects that are blurred as if they were farther away by this distance, m. They still hide what they
    /// hide at their own depth.
    struct Offset {
        ObjectChoice object;
        double metres = 0;
    };
    std::vector<Offset> offsets;
};

/// Applies holdouts, sharp objects and offsets to the samples of a picture. An object's own depth always
/// decides what it hides. An offset that would move an object to the camera or behind it places it 1 mm from
/// the camera. Throws what `choose_samples` throws.
void apply_object_effects(ForeignPicture& picture, const ObjectEffects& effects, double inverse_focus_per_m);

}  // namespace postlens
