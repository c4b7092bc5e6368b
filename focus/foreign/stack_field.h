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
    RasterWindow drawn;   ///< pixels that are drawn, within `window`; all other pixels are 0
    int views = default_lens_views;
    int set = 0;          ///< number of the set of views (focus/light_field/lens_views.h)
    bool shares = false;  ///< whether to compute StackField::shares as well

    /// How much farther than the CoC radius spherical aberration moves light.
    [[nodiscard]] double aberration_px() const {
        return std::abs(geometry.gain_px * geometry.aperture_radius_m * aperture.spherical_per_m());
    }
};

/// Share of a pixel that shows one object, on one side of the focus.
struct ObjectShare {
    std::uint32_t id = 0;  ///< 0: samples without an id
    int side = 0;          ///< -1 in front of the focus, 1 behind; 0: a CoC diameter of at most 1 px
    float share = 0;       ///< share of the pixel; the shares of a pixel add up to its alpha
};

struct StackField {
    Image image;  ///< premultiplied; `alpha` has a value for every pixel
    /// Per pixel of the window, the fraction of its views that see what the picture does not show: what lies
    /// beyond its border, or behind what it shows. Empty space behind a pixel counts as seen.
    std::vector<float> unseen;
    std::vector<std::vector<ObjectShare>> shares;  ///< per pixel of the window; empty if not computed
};

/// Draws a view of the image from each lens point and returns the mean of the views.
///
/// Each sample of a pixel's stack is drawn as a quadrilateral, the square of its pixel. A corner is
/// reprojected with the mean inverse depth of all samples of the same surface that meet at this corner.
/// Samples belong to one surface if their ids are equal or unknown and their CoC radii differ by less than a
/// pixel (beyond 16 px: by less than a 16th).
///
/// A view has one sample point in each pixel. Of the quadrilaterals there, the nearest opaque one is visible.
/// A quadrilateral is opaque in a fraction of the views that equals its alpha (stochastic transparency
/// [enderton2010]), independently of all others; its thresholds are distributed uniformly over the views.
/// `behind` adds the estimated surface behind a pixel, where one is known, to the end of the pixel's stack;
/// `behind` may be empty.
///
/// The expected value of the image is "over" along each ray through the lens. The result is bit-identical for
/// any number of threads and any `drawn`. Throws Error(wrong_arguments) for a number of views out of range,
/// and Error(out_of_memory).
[[nodiscard]] StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                     const StackFieldSettings& settings);

/// Divides colours and alpha by the share of the views that see what the picture shows. Returns this share
/// for each pixel.
std::vector<float> divide_by_seen(StackField& field);

}  // namespace postlens
