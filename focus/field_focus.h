// The light field over the lens and the shutter's time: what is recorded, seen from many points of the lens,
// each at its own instant.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "focus/frame.h"
#include "focus/lens_views.h"
#include "focus/splat_tables.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "lens/shutter_curve.h"
#include "records/image.h"
#include "records/sample_file.h"
#include "reproject/patch_field.h"
#include "reproject/raster_map.h"
#include "reproject/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// What moves while the light comes in.
struct FieldShutter {
    const FrameMotion* motion = nullptr;
    double open_s = 0, close_s = 0;
    ShutterCurve curve = ShutterCurve::box();
};

struct FieldFocusSettings {
    FocusGeometry geometry;  ///< in traced pixels
    Aperture aperture;
    RasterWindow window;  ///< the pixels wanted
    int views = default_lens_views;
    std::optional<FieldShutter> shutter;  ///< absent: the frame's own instant
    /// Leave out where nothing moves and the picture shows one surface only (what is scattered is right
    /// there), if that is at least this share of the pixels; absent: nothing is left out.
    std::optional<double> leave_out_from_share;
    RecordsRead also;  ///< told of the records of the frame's own instant
    /// Only these pixels of the window are drawn; whatever else is in the result says nothing. What is drawn
    /// has the same bits as without.
    std::optional<Crop> crop;
    int piece_px = SeenTile::edge;  ///< PatchField's
    /// What the surfaces may take; where they would take more, they are read for each picture, strip by strip
    /// of it, a quarter of that at a time. The same bits.
    std::uint64_t surface_bytes = std::uint64_t{1} << 30;
    /// Looks wherever the records are not sure what a view sees; none: what they have stands. Of highlights
    /// only those of surfaces that rays can see without are spread by themselves; nothing is left out, and
    /// nothing stays unknown.
    const SightRays* rays = nullptr;
};

struct FieldFocus {
    Image image;
    std::vector<float> unknown;        ///< by pixel, the share of its light that no record shows
    std::vector<float> unknown_below;  ///< the same of what is seen in mirrors and through glass
    std::vector<float> guessed_below;  ///< and of it, what no other view sees either
    /// By pixel, with rays: the share of its views that was traced. Else empty.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;  ///< by pixel, of sets with `checked`; else empty
    /// By pixel, of highlights that are spread by themselves: the mean square of the light that single rays
    /// would meet, which is what makes rays noisy there. Empty where there are none.
    std::vector<float> light_square;
    /// By pixel: 1 where it was left out, as asked for; empty if it was not.
    std::vector<std::uint8_t> left_out;
    /// Of the pixels that were asked for.
    [[nodiscard]] double unknown_share(const std::optional<Crop>& crop = std::nullopt) const;
};

/// Which views a picture is the mean of.
struct FieldViews {
    int count = default_lens_views;
    int set = 0;    ///< sets have points of their own, so that their errors are independent; see lens_views.h
    int first = 0;  ///< of the set, the number of the first: what a picture lacks of more views
    /// Whether a rectangle of the window is wanted; none: all is. What is not is left as filling gaps makes
    /// it.
    std::function<bool(int x, int y, int width, int height)> wanted;
    std::optional<double> leave_out_from_share;  ///< as in FieldFocusSettings; of a set alone
    /// With rays: PatchViews's.
    std::function<bool(int x, int y)> left_to_rays;
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Which of the pictures that are drawn together they belong to. Those of one picture want different
    /// tiles of SeenTile::edge px.
    std::size_t picture = 0;
};

class FieldStrips;
struct OneSurface;

/// The surfaces prepared for one lens, of which several pictures are drawn. Keeps a reference to the frame.
class FieldFocuser {
  public:
    /// `views` and `leave_out_from_share` of the settings do not count.
    FieldFocuser(FocusFrame& frame, FieldFocusSettings settings);
    ~FieldFocuser();
    FieldFocuser(const FieldFocuser&) = delete;
    FieldFocuser& operator=(const FieldFocuser&) = delete;
    FieldFocuser(FieldFocuser&&) = delete;
    FieldFocuser& operator=(FieldFocuser&&) = delete;

    /// Same bits for any number of threads.
    [[nodiscard]] FieldFocus draw(const FieldViews& views) const;
    /// The same of several sets, in less time than one after the other.
    [[nodiscard]] std::vector<FieldFocus> draw(std::span<const FieldViews> sets) const;

  private:
    struct Prepared;
    [[nodiscard]] PatchField outline() const;
    /// By which the share u of the shutter's light has come in.
    [[nodiscard]] double instant_s(double u) const;
    [[nodiscard]] std::vector<PatchView> views_at(std::span<const LensViewPoint> points) const;
    /// Where a set says that one surface is to be left out, of what the strips have or of all.
    [[nodiscard]] std::optional<OneSurface> one_surface(std::span<const FieldViews> sets,
                                                        FieldStrips* strips) const;
    FocusFrame& frame_;
    FieldFocusSettings settings_;
    std::unique_ptr<Prepared> prepared_;
};

/// Same bits for any number of threads.
[[nodiscard]] FieldFocus field_focus(FocusFrame& frame, const FieldFocusSettings& settings);

}  // namespace postlens
