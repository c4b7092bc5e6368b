// Blurs an image from another program as a light field: the image is drawn as seen from many lens points, and
// the blurred image is the mean of these images.
#pragma once

#include <cmath>
#include <vector>

#include "focus/foreign/behind_fill.h"
#include "focus/light_field/lens_views.h"
#include "focus/responses/node_response.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

struct StackFieldSettings {
    FocusGeometry geometry;
    Aperture aperture;
    RasterWindow window;  ///< the raster pixels of the image
    RasterWindow drawn;   ///< the pixels to draw, within `window`; all other pixels are 0
    int views = default_lens_views;
    int set = 0;          ///< number of the set of views (focus/light_field/lens_views.h)
    bool shares = false;  ///< whether to compute StackField::shares as well

    /// Distance, in px, by which spherical aberration spreads light beyond the CoC radius.
    [[nodiscard]] double aberration_px() const {
        return std::abs(geometry.gain_px * geometry.aperture_radius_m * aperture.spherical_per_m());
    }
};

/// The fraction of a pixel in which one object is visible. Parts in front of, in and behind the focus are
/// counted separately.
struct ObjectShare {
    std::uint32_t id = 0;  ///< 0 for samples without an id
    int side = 0;          ///< -1 in front of the focus, 1 behind, 0 if the CoC diameter is at most 1 px
    float share = 0;       ///< share of the pixel; the shares of a pixel add up to its alpha
};

struct StackField {
    /// The image that the lens forms, with premultiplied colours and alpha. Alpha is a mean over lens points
    /// for which translucent samples are made opaque at random. Therefore it has noise, and may exceed 1.
    Image image;
    /// For each pixel, the fraction of lens points that see none of the file's surfaces there. For example,
    /// they look past the image border, or see behind an edge what the file does not contain. But if the file
    /// itself shows empty space in the pixel, no surface is missing, so the value is 0.
    std::vector<float> unseen;
    /// For each pixel, its mean alpha over the lens points. Objects that only hide others (holdouts) count,
    /// too. The function divide_by_covered() divides the pixel's colour and alpha by this value, because some
    /// lens points may see nothing, for example near the image border. Where the file shows empty space in
    /// the pixel, the value is at least 1, so the division does not make the pixel opaque.
    std::vector<float> covered;
    std::vector<std::vector<ObjectShare>> shares;  ///< per pixel of the window; empty if not computed
};

/// Draws an image as seen from many lens points, and returns the mean. `behind` has the estimated surface
/// behind the visible surface of each pixel, or is empty.
///
/// Each sample is drawn as a quadrilateral that covers its pixel. It counts as opaque for a random fraction
/// of the lens points. This fraction equals its alpha (stochastic transparency [enderton2010]).
///
/// The result is bit-identical for any number of threads, and does not depend on which other pixels are drawn
/// (`settings.drawn`). Throws Error(wrong_arguments) if the number of lens points (`settings.views`) is out
/// of range. Throws Error(out_of_memory).
[[nodiscard]] StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                     const StackFieldSettings& settings);

/// Divides the colours and alpha of each pixel by `field.covered`, the pixel's mean alpha over the lens
/// points. Near the image border, some lens points see only what lies beyond the border, where the file has
/// no surface. Without this division, pixels there would be too dark.
void divide_by_covered(StackField& field);

}  // namespace postlens
