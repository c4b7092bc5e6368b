// The light field of an image of another program: the mean of its views from many lens points.
#pragma once

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
    RasterWindow drawn;   ///< those that are drawn, within `window`; the others are 0
    int views = default_lens_views;
    int set = 0;          ///< sets have independent lens points and errors (focus/light_field/lens_views.h)
    bool shares = false;  ///< also finds StackField::shares
};

/// What a pixel of the image shows of one object on one side of the focus.
struct ObjectShare {
    std::uint32_t id = 0;  ///< 0: samples without an id
    int side = 0;          ///< -1 in front of the focus, 1 behind; 0: a CoC diameter of at most 1 px
    float share = 0;       ///< of the pixel; all of a pixel add up to its alpha
};

struct StackField {
    Image image;  ///< premultiplied; `alpha` has a value for every pixel
    /// Per pixel of the window: the share of its views that meet no sample at all.
    std::vector<float> unseen;
    std::vector<std::vector<ObjectShare>> shares;  ///< per pixel of the window; empty unless it is asked for
};

/// Draws the image from each lens point and takes the mean.
///
/// A sample of a pixel's stack is a quadrilateral: the square of its pixel, whose corners are reprojected
/// with the mean inverse depth of the samples of the same surface that meet there. Samples belong to one
/// surface if their ids do not differ and their CoC radii differ by less than a pixel (beyond 16 px by less
/// than a 16th). A view takes one point of each pixel, and of the quadrilaterals there the nearest hides the
/// others, in the share of views that is its alpha (stochastic transparency [enderton2010], with thresholds
/// that are spread evenly over the views). `behind` adds one sample to the end of each stack whose estimate
/// is known; it may be empty.
///
/// The expected value of the image is "over" along each ray through the lens. The result is bit-identical for
/// any number of threads and any `drawn`. Throws Error(wrong_arguments) for a number of views out of range,
/// and Error(out_of_memory).
[[nodiscard]] StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                     const StackFieldSettings& settings);

}  // namespace postlens
