// Adds channels for compositing to a focused image: CoC, Cryptomatte, error, and the shares of each pixel in
// front of, in and behind the focus.
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

/// Adds the channels to a focused image. Views through the lens measure the share of each object in a pixel.
/// The shares are then scaled to add up to the pixel's alpha.
///
/// A pixel is in focus if its CoC diameter is at most 1 px. The CoC is negative in front of the focus, and 0
/// where nothing is hit or stored.
///
/// `effect` is the strength of the blur in each pixel: 0 is the pinhole image, 1 is fully blurred. If it is
/// empty, all pixels are fully blurred.
///
/// Returns the fraction of pixels that show more objects than the Cryptomatte has ranks (objects per pixel).
/// Their smallest coverages are left out.
///
/// Throws Error(wrong_arguments) if the image has no Cryptomatte, or if the method or the impulse response
/// does not support a channel. Throws Error(out_of_memory).
double add_focus_passes(const ForeignPicture& picture, const FocusSettings& settings,
                        const FocusPasses& passes, Image& image, const std::vector<float>& effect = {});

}  // namespace postlens
