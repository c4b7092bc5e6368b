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
    /// Whether to leave out pixels in which all lens points see the same static surface, because the simpler
    /// method `scatter` is exact there. They are left out, and marked in FieldFocus::left_out, if they are at
    /// least this fraction of all pixels. If the value is absent, all pixels are drawn.
    std::optional<double> leave_out_from_share;
    RecordsRead also;  ///< called with the records of the frame's own instant as they are read
    /// If set, only the pixels in this rectangle are drawn, bit-identical to those of the whole image. All
    /// other pixels are undefined.
    std::optional<Crop> crop;
    int piece_px = SeenTile::edge;  ///< PatchField::piece_px
    /// Memory limit, in bytes, for the surfaces of the sample file. If they need more memory, the image is
    /// drawn in groups of rows, one after another. For each group, only the surfaces that it shows are read
    /// from the file. The image is bit-identical.
    std::uint64_t surface_bytes = std::uint64_t{1} << 30;
    /// Ray tracer for what the sample file does not contain. Wherever a lens point sees such a part of the
    /// scene in a pixel, a ray is traced there. If null, no rays are traced.
    const SightRays* rays = nullptr;
};

/// An image with lens blur, which is the mean of the images that the lens points see. In some pixels, no lens
/// point sees a surface of the sample file. These pixels are filled from the surrounding pixels.
struct FieldFocus : PatchPicture {
    std::vector<std::uint8_t> left_out;  ///< 1 if left out (leave_out_from_share); empty if none is
};

/// Selects the lens points from which the scene is drawn; the image is the mean of what they see. They are
/// `count` consecutive points, from the point number `first` on, of a Sobol sequence that is scrambled at
/// random. `set` is the number of the scrambling.
struct FieldViews {
    int count = default_lens_views;
    int set = 0;    ///< sets have independent lens points and thus independent errors (lens_views.h)
    int first = 0;  ///< index of the first view; it is above 0 if a set is continued
    /// Selects the part of the image to be drawn; if this function is empty, the whole image is drawn. It
    /// returns whether to draw a square of the image, given its upper left pixel and its size, in px. The
    /// pixels of all other squares are undefined.
    std::function<bool(int x, int y, int width, int height)> wanted;
    std::optional<double> leave_out_from_share;  ///< see FieldFocusSettings; only for a single set
    // The following functions control traced rays. They are called for a pixel (x, y), and described at
    // PatchViews:
    // - `left_to_rays` selects the samples of the views that rays compute instead of the recorded surfaces.
    // - `checked` selects the views in which a ray measures the error of the recorded colour.
    // - `aimed` selects random pixels in which rays measure the error of the highlights (very bright light).
    //   It returns the probability of the selection, or 0 for all other pixels.
    std::function<LeftToRays(int x, int y)> left_to_rays;
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    std::function<double(int x, int y)> aimed;
    /// Index of the image to which this set of lens points contributes, because several images can be drawn
    /// together. If several sets contribute to the same image, each must draw other squares of it. Their
    /// functions `wanted` select these squares.
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
    /// Returns an instant during the exposure, in s. Until this instant, the fraction `u` (0 to 1) of the
    /// exposure's light has passed the shutter. So if the values of `u` are equally distributed, instants at
    /// which the shutter is open wider are more frequent.
    [[nodiscard]] double instant_s(double u) const;
    [[nodiscard]] std::vector<PatchView> views_at(std::span<const LensViewPoint> points) const;
    /// Finds the pixels in which all lens points see the same single surface, because the simpler method
    /// `scatter` is exact there. Returns nothing if all pixels must be drawn, for example because rays are
    /// traced or objects move.
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
