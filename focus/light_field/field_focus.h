// The light field over lens and shutter: reprojects the records to many views, each from its own lens point
// and at its own instant, and averages the views.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "focus/frame.h"
#include "focus/light_field/lens_views.h"
#include "focus/scatter/splat_tables.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "lens/shutter_curve.h"
#include "pictures/image.h"
#include "records/sample_file.h"
#include "reproject/patch_field.h"
#include "reproject/raster_map.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// An open shutter: its interval, the weight of each instant, and the motion during the interval.
struct FieldShutter {
    const FrameMotion* motion = nullptr;
    double open_s = 0, close_s = 0;
    ShutterCurve curve = ShutterCurve::box();
};

struct FieldFocusSettings {
    FocusGeometry geometry;  ///< in px of the traced raster
    Aperture aperture;
    RasterWindow window;  ///< the raster pixels of the image
    int views = default_lens_views;
    std::optional<FieldShutter> shutter;  ///< none: all views show the frame's own instant
    /// If present, pixels are left out in which nothing moves and all views see one surface, because
    /// scattering is exact for them. This happens only if such pixels make up at least this share of the
    /// image. If absent, all pixels are drawn.
    std::optional<double> leave_out_from_share;
    RecordsRead also;  ///< called with the records of the frame's own instant while they are read
    /// Draws only these pixels of the window, bit-identical to those of the whole image. All other pixels are
    /// undefined.
    std::optional<Crop> crop;
    int piece_px = SeenTile::edge;  ///< PatchField::piece_px
    /// Memory limit for the surfaces, bytes. If all surfaces together need more, they are read again for each
    /// image, in strips that need a quarter of the limit. The result is bit-identical.
    std::uint64_t surface_bytes = std::uint64_t{1} << 30;
    /// Traces rays for samples of views whose colours the records do not determine. With rays, only
    /// highlights whose radiance is the same for all rays are spread by their impulse responses, and no pixel
    /// is left out or unknown. Null: no rays.
    const SightRays* rays = nullptr;
};

/// The mean of the views, with one value per pixel of the window. Pixels that no view knows are filled from
/// their surroundings.
struct FieldFocus : PatchPicture {
    std::vector<std::uint8_t> left_out;  ///< 1: left out (leave_out_from_share); empty if none is
};

/// The views whose mean is an image: views [first, first + count) of a set. The lens points of a set form one
/// scrambled Sobol sequence.
struct FieldViews {
    int count = default_lens_views;
    int set = 0;    ///< sets have independent lens points and errors (lens_views.h)
    int first = 0;  ///< index of the first view; more than 0 continues a set
    /// Returns whether a square piece of the image is drawn. If empty, all pieces are drawn. Pieces that are
    /// not drawn are filled from their surroundings.
    std::function<bool(int x, int y, int width, int height)> wanted;
    std::optional<double> leave_out_from_share;  ///< see FieldFocusSettings; only for a single set
    // Only with rays. All are defined in PatchViews.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    std::function<double(int x, int y)> aimed;
    /// Index of the image to which this set of views belongs, among the images drawn together. Sets of one
    /// image must draw different pieces of it.
    std::size_t picture = 0;
};

class FieldStrips;
struct OneSurface;

/// Prepares the surfaces of a frame, to draw several images with one lens. Keeps a reference to the frame.
class FieldFocuser {
  public:
    /// `settings.views` and `settings.leave_out_from_share` are ignored.
    FieldFocuser(FocusFrame& frame, FieldFocusSettings settings);
    ~FieldFocuser();
    FieldFocuser(const FieldFocuser&) = delete;
    FieldFocuser& operator=(const FieldFocuser&) = delete;
    FieldFocuser(FieldFocuser&&) = delete;
    FieldFocuser& operator=(FieldFocuser&&) = delete;

    /// Draws the image of one set of views. The result is bit-identical for any number of threads.
    [[nodiscard]] FieldFocus draw(const FieldViews& views) const;
    /// Draws several sets of views together, which is faster than drawing one after the other.
    [[nodiscard]] std::vector<FieldFocus> draw(std::span<const FieldViews> sets) const;

  private:
    struct Prepared;
    [[nodiscard]] PatchField outline() const;
    /// Converts a fraction u of the exposure, from 0 to 1, to an instant. The fraction u of the light arrives
    /// before this instant.
    [[nodiscard]] double instant_s(double u) const;
    [[nodiscard]] std::vector<PatchView> views_at(std::span<const LensViewPoint> points) const;
    /// Finds the pixels to leave out because they show a single surface (OneSurface), from the strips or from
    /// the whole image. Returns nothing if no set of views leaves pixels out.
    [[nodiscard]] std::optional<OneSurface> one_surface(std::span<const FieldViews> sets,
                                                        FieldStrips* strips) const;
    FocusFrame& frame_;
    FieldFocusSettings settings_;
    std::unique_ptr<Prepared> prepared_;
};

/// Draws one image. The result is bit-identical for any number of threads.
[[nodiscard]] FieldFocus field_focus(FocusFrame& frame, const FieldFocusSettings& settings);

}  // namespace postlens
