// Effects that a compositor applies to single objects before the lens: holdouts, sharp objects, and offsets
// in depth.
#pragma once

#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/object_choice.h"

namespace postlens {

struct ObjectEffects {
    /// Holdouts: objects that hide the surfaces behind them, with sharp edges, but add neither colour nor
    /// alpha to the image.
    std::vector<ObjectChoice> holdouts;
    /// Objects that are not blurred.
    std::vector<ObjectChoice> sharp;
    /// Objects that are blurred as if they were farther away by this distance, m. Occlusion still uses their
    /// true depth.
    struct Offset {
        ObjectChoice object;
        double metres = 0;
    };
    std::vector<Offset> offsets;
};

/// Applies holdouts, sharp objects and depth offsets to the samples of a picture. Occlusion always uses an
/// object's true depth. If an offset would move an object to the camera or behind it, the object is placed 1
/// mm in front of the camera, and picture.repairs gets the warning `offset`. Throws the errors of
/// `choose_samples`.
void apply_object_effects(ForeignPicture& picture, const ObjectEffects& effects, double inverse_focus_per_m);

}  // namespace postlens
