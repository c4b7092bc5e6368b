// The light field over the lens: what is recorded, seen from many points of it.
#pragma once

#include "focus/run_scatter.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

struct FieldFocusSettings {
    FocusGeometry geometry;  ///< in traced pixels
    Aperture aperture;
    RasterWindow window;  ///< the pixels wanted
    int views = 64;
};

struct FieldFocus {
    Image image;
    double unknown_share = 0;  ///< of all pixels' light: no record shows what is seen there
};

/// Same bits for any number of threads.
[[nodiscard]] FieldFocus field_focus(const SampleFileReader& file, const FieldFocusSettings& settings);

}  // namespace postlens
