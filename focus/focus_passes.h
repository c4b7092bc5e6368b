// Adds channels for compositing to a focused image: the CoC, Cryptomatte, the error, and the shares of each
// pixel that lie in front of, in and behind the focus.
#pragma once

#include <string>
#include <vector>

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

struct FocusPasses {
    bool coc = false;    ///< signed CoC diameter, px, of the surface that the pinhole sees
    bool sides = false;  ///< focus.before, focus.in, focus.behind: shares of the pixel that add up to alpha
    bool cryptomatte = false;  ///< the image's Cryptomatte seen through the lens; coverages add up to alpha
    bool error = false;        ///< standard error of the mean over the views; only with `lightfield`
    /// Returns whether any of the channels is measured by views.
    [[nodiscard]] bool by_views() const { return sides || cryptomatte || error; }
    [[nodiscard]] bool any() const { return coc || by_views(); }
};

/// Adds the channels to a focused image. The shares of the objects in a blurred pixel are measured with
/// `settings.views` views through the lens (focus/foreign/stack_field.h). They are then scaled so that they
/// add up to the pixel's alpha. A pixel is in focus if its CoC diameter is at most 1 px. The CoC is negative
/// in front of the focus, and 0 where nothing is hit or stored.
///
/// `effect` is the effect of the lens on each pixel with which the image was made: 0 for a pixel of the
/// pinhole image, 1 for a fully blurred pixel. If `effect` is empty, it is 1 everywhere.
///
/// Returns the fraction of the pixels that show more objects than the Cryptomatte has ranks. There, the
/// smallest coverages are left out. The Cryptomatte has as many ranks as that of `picture`, but at least 8.
///
/// Throws Error(wrong_arguments) if the image has no Cryptomatte, or if a channel is not available with the
/// method or the impulse response. Throws Error(out_of_memory).
double add_focus_passes(const ForeignPicture& picture, const FocusSettings& settings,
                        const FocusPasses& passes, Image& image, const std::vector<float>& effect = {});

}  // namespace postlens
