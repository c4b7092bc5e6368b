// The light field over the lens and the shutter's time: what is recorded, seen from many points of the lens,
// each at its own instant.
#pragma once

#include <optional>

#include "focus/lens_views.h"
#include "focus/splat_tables.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "lens/shutter_curve.h"
#include "records/image.h"
#include "records/sample_file.h"
#include "reproject/raster_map.h"
#include "reproject/sheet_mesh.h"

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
    RecordsRead also;  ///< told of the records of the frame's own instant; none: nobody is
};

struct FieldFocus {
    Image image;
    std::vector<float> unknown;        ///< by pixel, the share of its light that no record shows
    std::vector<float> unknown_below;  ///< the same of what is seen in mirrors and through glass
    /// By pixel: 1 where it was left out, as asked for; empty if it was not.
    std::vector<std::uint8_t> left_out;
    [[nodiscard]] double unknown_share() const;
};

/// Same bits for any number of threads.
[[nodiscard]] FieldFocus field_focus(const SampleFileReader& file, const FieldFocusSettings& settings);

}  // namespace postlens
