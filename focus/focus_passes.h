// Adds channels for compositing to a blurred image: CoC, Cryptomatte (object masks), the standard error of
// its pixels, and the fractions of each pixel in front of, in and behind the focus.
#pragma once

#include <string>
#include <vector>

#include "focus/focus.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

struct FocusPasses {
    bool coc = false;          ///< signed CoC diameter in px without blur; negative in front of the focus
    bool sides = false;        ///< shares in front of, in (CoC up to 1 px) and behind the focus; sum is alpha
    bool cryptomatte = false;  ///< the image's Cryptomatte seen through the lens; coverages add up to alpha
    bool error = false;        ///< standard error of the mean over the views; only with `lightfield`
    /// Returns whether any channel needs images from single lens points (views).
    [[nodiscard]] bool by_views() const { return sides || cryptomatte || error; }
    [[nodiscard]] bool any() const { return coc || by_views(); }
};

/// Adds channels for compositing, such as the CoC or object masks, to the blurred `image`. The flags of
/// `passes` select the channels. `effect` states, for each pixel, the strength with which the image was
/// blurred, from 0 to 1, so that the channels match the image. If `effect` is empty, the strength is 1.
///
/// Returns the fraction of pixels that show more objects than the Cryptomatte channels (object masks) can
/// store per pixel. In these pixels, the objects with the smallest coverages are left out.
///
/// Throws Error(wrong_arguments) if a channel is not available. Throws Error(out_of_memory).
double add_focus_passes(const ForeignPicture& picture, const FocusSettings& settings,
                        const FocusPasses& passes, Image& image, const std::vector<float>& effect = {});

}  // namespace postlens
