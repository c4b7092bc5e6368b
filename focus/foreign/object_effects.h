// Effects that a compositor applies to single objects before the image is blurred: holdouts (hide others, but
// are not drawn), sharp objects, and offsets in depth.
#pragma once

#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/object_choice.h"

namespace postlens {

struct ObjectEffects {
    /// Objects that hide what is behind them, but add neither colour nor alpha to the image. Their edges are
    /// sharp.
    std::vector<ObjectChoice> holdouts;
    /// Objects that are not blurred.
    std::vector<ObjectChoice> sharp;
    /// An object that is blurred as if it were `metres` farther away than it is. A negative value means
    /// nearer. Only the blur changes: which objects it hides, and which hide it, still depends on its true
    /// depth.
    struct Offset {
        ObjectChoice object;
        double metres = 0;
    };
    std::vector<Offset> offsets;
};

/// Applies the effects (holdouts, sharp objects, offsets in depth) to the samples of `picture`. `effects`
/// names the objects for each effect. Throws the errors of `choose_samples`.
///
/// If an offset would move a sample nearer than 1 mm to the camera, the sample is moved to 1 mm instead, and
/// the warning `offset` is added to picture.repairs.
void apply_object_effects(ForeignPicture& picture, const ObjectEffects& effects, double inverse_focus_per_m);

}  // namespace postlens
