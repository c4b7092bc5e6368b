// Further channels for compositors in the file of a focused image: CoC, shares by depth, Cryptomatte and
// error.
#pragma once

#include <string>
#include <vector>

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

struct FocusPasses {
    bool coc = false;    ///< CoC: signed diameter of the circle of confusion of what the pinhole sees, px
    bool sides = false;  ///< focus.before, focus.in, focus.behind: shares of the pixel, adding up to alpha
    bool cryptomatte = false;  ///< the picture's Cryptomatte through the lens; coverages add up to alpha
    bool error = false;        ///< error: standard error of the mean over the views; of `lightfield` alone
    [[nodiscard]] bool any() const { return coc || sides || cryptomatte || error; }
};

/// Adds the channels to a focused image. The share of each object in a blurred pixel is found from
/// `settings.views` views through the lens (focus/foreign/stack_field.h), and scaled so that a pixel's shares
/// add up to the alpha of the image, whatever method made the image. A pixel in focus has a CoC diameter of
/// at most 1 px. CoC is 0 where nothing is hit or nothing is stored, and negative in front of the focus.
/// Throws Error(wrong_arguments) if the image has no Cryptomatte or a channel is not available with the
/// method or the impulse response, and Error(out_of_memory).
void add_focus_passes(const ForeignPicture& picture, const FocusSettings& settings, const FocusPasses& passes,
                      Image& image);

}  // namespace postlens
