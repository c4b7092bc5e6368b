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
    /// Premultiplied colours. `alpha` has a value for every pixel. It may exceed 1, because chance decides
    /// which samples are opaque in a view.
    Image image;
    /// Per pixel of the window, the fraction of the views that look past everything the image shows: beyond
    /// its border, or behind the last sample of a stack. Empty space behind a pixel counts as shown.
    std::vector<float> unseen;
    /// Per pixel of the window, the sum of the alphas of all visible samples, including holdouts, as a mean
    /// over the views. Its expected value is 1 minus that of `unseen`. At least 1 for a pixel with empty
    /// space behind it.
    std::vector<float> covered;
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
/// Samples at the border of the image continue beyond it as BorderExtension states.
/// `behind` adds the estimated surface behind a pixel, where one is known, to the end of the pixel's stack;
/// `behind` may be empty.
///
/// The expected value of the image is "over" along each ray through the lens. The result is bit-identical for
/// any number of threads and any `drawn`. Throws Error(wrong_arguments) for a number of views out of range,
/// and Error(out_of_memory).
[[nodiscard]] StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                     const StackFieldSettings& settings);

/// Divides colours and alpha by StackField::covered, and limits alpha to 1. The views of a pixel that see
/// something thus also represent those that look past the image. If no view of a pixel sees anything, the
/// pixel keeps its values.
void divide_by_covered(StackField& field);

}  // namespace postlens
