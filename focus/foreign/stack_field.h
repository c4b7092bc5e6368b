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

/// The share of a pixel that shows one object. Parts in front of, in and behind the focus are counted
/// separately.
struct ObjectShare {
    std::uint32_t id = 0;  ///< 0 for samples without an id
    int side = 0;          ///< -1 in front of the focus, 1 behind, 0 if the CoC diameter is at most 1 px
    float share = 0;       ///< share of the pixel; the shares of a pixel add up to its alpha
};

struct StackField {
    /// The mean of the views, with premultiplied colours and alpha. Alpha is a random estimate, so it may
    /// exceed 1.
    Image image;
    /// Per pixel of the window, the fraction of views in which its content is unknown. Such a view looks past
    /// the image's border or past the pixel's last sample. Empty space is not unknown.
    std::vector<float> unseen;
    /// Per pixel of the window, the mean alpha over the views that the lens transmits. Holdouts count. On
    /// average it is 1 minus `unseen`. In a pixel with empty space behind its samples, it is at least 1,
    /// because empty space is not unknown.
    std::vector<float> covered;
    std::vector<std::vector<ObjectShare>> shares;  ///< per pixel of the window; empty if not computed
};

/// Draws a view of the image from each lens point and returns the mean of the views.
///
/// Each sample is drawn as a quadrilateral, the square of its pixel. Its corners are reprojected with the
/// mean inverse depth of the samples of its surface that meet there (are_one_surface).
///
/// A view shows the nearest opaque quadrilateral at one sample point per pixel. A quadrilateral is opaque in
/// a random fraction of the views that equals its alpha (stochastic transparency [enderton2010]). On average,
/// this equals compositing with "over" along each ray.
///
/// `behind` has the estimated surface behind each pixel, or is empty. Samples at the border are continued
/// beyond it (BorderExtension).
///
/// The result is bit-identical for any number of threads and any `drawn`. Throws Error(wrong_arguments) if
/// the number of views is out of range. Throws Error(out_of_memory).
[[nodiscard]] StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                     const StackFieldSettings& settings);

/// Divides the colours and alpha of each pixel by StackField::covered, so that views past the image do not
/// darken it. Alpha is limited to 1. Pixels with `covered` = 0 do not change.
void divide_by_covered(StackField& field);

}  // namespace postlens
