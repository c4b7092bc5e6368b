// Computes an image with lens blur and motion blur as a light field. It is the mean of many images, each
// reprojected from the recorded samples to one lens point and one instant.
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

/// The exposure of a frame.
/// - `motion`: how the objects and the camera move
/// - `open_s`, `close_s`: instants, in s, at which the shutter opens and closes
/// - `curve`: how much each instant between them counts; by default, all count equally
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
    std::optional<FieldShutter> shutter;  ///< if absent, all views show the frame's own instant
    /// If all lens points see the same static surface in a pixel, the pixel needs no views, because the
    /// simpler method `scatter` is exact there. This value is the smallest fraction of all pixels for which
    /// it is worthwhile to leave such pixels out. They are then marked in FieldFocus::left_out. If it is not
    /// set, all pixels are drawn.
    std::optional<double> leave_out_from_share;
    RecordsRead also;  ///< called with the records of the frame's own instant as they are read
    /// If set, only the pixels in this rectangle are drawn, bit-identical to those of the whole image. All
    /// other pixels are undefined.
    std::optional<Crop> crop;
    int piece_px = SeenTile::edge;  ///< PatchField::piece_px
    /// Memory limit, in bytes, for the recorded surfaces. If they need more memory, the image is drawn in
    /// groups of rows, one after another, with only the surfaces that each group needs. The result is
    /// bit-identical.
    std::uint64_t surface_bytes = std::uint64_t{1} << 30;
    /// Ray tracer that replaces what the sample file does not contain: if a lens point sees such a part of
    /// the scene in a pixel, a ray is traced there. If null, no rays are traced.
    const SightRays* rays = nullptr;
};

/// An image with lens blur, which is the mean of the images that the lens points see. In some pixels, no lens
/// point sees a surface of the sample file. These pixels are filled from the surrounding pixels.
struct FieldFocus : PatchPicture {
    std::vector<std::uint8_t> left_out;  ///< 1 if left out (leave_out_from_share); empty if none is
};

/// Selects the lens points from which the scene is drawn; the image is the mean of what they see. They are
/// `count` consecutive points of a scrambled Sobol sequence, beginning with the point number `first`. `set`
/// is the number of the sequence, and each number gives another scrambling.
struct FieldViews {
    int count = default_lens_views;
    int set = 0;    ///< sets have independent lens points and thus independent errors (lens_views.h)
    int first = 0;  ///< index of the first view; it is above 0 if a set is continued
    /// Returns whether to draw this square of the image. Pixels of all other squares are undefined. If no
    /// function is set, the whole image is drawn.
    std::function<bool(int x, int y, int width, int height)> wanted;
    std::optional<double> leave_out_from_share;  ///< see FieldFocusSettings; only for a single set
    // The following three functions are used only if rays are traced. For an image square or pixel, they
    // select which samples of the views rays replace (`left_to_rays`), in which views rays measure the error
    // of the recorded light (`checked`), and whether rays measure the error of the highlights (`aimed`).
    // PatchViews describes them.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    std::function<double(int x, int y)> aimed;
    /// Several images can be drawn together, each from one or more sets of lens points. This is the index of
    /// the image to which this set belongs. If several sets belong to one image, their functions `wanted`
    /// must select different squares of it.
    std::size_t picture = 0;
};

class FieldStrips;
struct OneSurface;

/// Draws several images of a frame through one lens, from surfaces that are prepared only once. Keeps a
/// reference to the frame.
class FieldFocuser {
  public:
    /// `settings.views` and `settings.leave_out_from_share` are ignored.
    FieldFocuser(FocusFrame& frame, FieldFocusSettings settings);
    ~FieldFocuser();
    FieldFocuser(const FieldFocuser&) = delete;
    FieldFocuser& operator=(const FieldFocuser&) = delete;
    FieldFocuser(FieldFocuser&&) = delete;
    FieldFocuser& operator=(FieldFocuser&&) = delete;

    /// Draws one image: the mean of the images that the lens points of the set `views` see. The result is
    /// bit-identical for any number of threads.
    [[nodiscard]] FieldFocus draw(const FieldViews& views) const;
    /// Draws the images of several sets of lens points in one pass, which is faster than one pass for each
    /// set. The results reuse the memory of the images in `reuse`, which must have the same size.
    [[nodiscard]] std::vector<FieldFocus> draw(std::span<const FieldViews> sets,
                                               std::vector<FieldFocus> reuse = {}) const;

  private:
    struct Prepared;
    [[nodiscard]] PatchField outline() const;
    /// Returns an instant during the exposure, in s. It is chosen so that the fraction `u` (0 to 1) of the
    /// exposure's light has passed the shutter before it. So equally distributed values of `u` give instants
    /// that are distributed as the shutter weights them.
    [[nodiscard]] double instant_s(double u) const;
    [[nodiscard]] std::vector<PatchView> views_at(std::span<const LensViewPoint> points) const;
    /// Finds the pixels in which all lens points see the same single surface. Their views need not be drawn,
    /// because the simpler method `scatter` is exact for such pixels. Returns nothing if all pixels must be
    /// drawn, for example because rays are traced or objects move.
    /// - `strips`: reads the surfaces in groups of rows, if they do not fit into memory
    [[nodiscard]] std::optional<OneSurface> one_surface(std::span<const FieldViews> sets,
                                                        FieldStrips* strips) const;
    FocusFrame& frame_;
    FieldFocusSettings settings_;
    std::unique_ptr<Prepared> prepared_;
};

/// Computes one image with lens blur, as the mean of the images from many lens points. The result is
/// bit-identical for any number of threads.
[[nodiscard]] FieldFocus field_focus(FocusFrame& frame, const FieldFocusSettings& settings);

}  // namespace postlens
