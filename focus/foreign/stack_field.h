// The light field of another program's image: the mean of views from many lens points.
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

/// The share of a pixel that shows one object. Parts of the object in front of, in and behind the focus are
/// counted separately.
struct ObjectShare {
    std::uint32_t id = 0;  ///< 0 for samples without an id
    int side = 0;          ///< -1 in front of the focus, 1 behind, 0 if the CoC diameter is at most 1 px
    float share = 0;       ///< share of the pixel; the shares of a pixel add up to its alpha
};

struct StackField {
    /// The mean of the views, with premultiplied colours and an alpha for every pixel. Alpha is a random
    /// estimate, so it may exceed 1.
    Image image;
    /// Per pixel of the window, the fraction of the views in which the pixel is unknown. Such a view looks
    /// past the image's border or past the pixel's last sample. Views that see empty space do not count.
    std::vector<float> unseen;
    /// Per pixel of the window: the mean, over the views that the lens does not block, of the alphas of the
    /// samples that they see, holdouts included. On average it is 1 minus `unseen`. In a pixel with empty
    /// space behind its samples, smaller values are raised to 1, because empty space is not unknown.
    std::vector<float> covered;
    std::vector<std::vector<ObjectShare>> shares;  ///< per pixel of the window; empty if not computed
};

/// Draws a view of the image from each lens point and returns the mean of the views.
///
/// Each sample of a pixel is drawn as a quadrilateral, the square of the pixel. Each corner of the square has
/// the mean inverse depth of the samples of the same surface that meet there (are_one_surface). The corner is
/// reprojected with this depth.
///
/// A view has one sample point in each pixel and shows the nearest opaque quadrilateral there. Each
/// quadrilateral is opaque in a random part of the views, whose fraction equals its alpha (stochastic
/// transparency [enderton2010]). The expected value of the image therefore equals compositing with "over"
/// along each ray through the lens.
///
/// `behind` contains the estimated surface behind each pixel, which is added to the end of the pixel's stack.
/// It may be empty. Samples at the border of the image are continued beyond the border (BorderExtension).
///
/// The result is bit-identical for any number of threads and any `drawn`. Throws Error(wrong_arguments) if
/// the number of views is out of range. Throws Error(out_of_memory).
[[nodiscard]] StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                     const StackFieldSettings& settings);

/// Divides the colours and alpha of each pixel by StackField::covered, and limits alpha to 1. Views that look
/// past the image thus do not darken the pixel. A pixel in which `covered` is 0 keeps its values.
void divide_by_covered(StackField& field);

}  // namespace postlens
