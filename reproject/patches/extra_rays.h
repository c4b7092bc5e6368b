// Additional rays in pixels where views alone are too noisy.
#pragma once

#include "reproject/patch_field.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/seen_light.h"
#include "reproject/patches/view_rays.h"

namespace postlens {

/// Traces additional rays in the pixels of a tile that PatchViews::extra_rays selects, for example at the
/// edges of very bright surfaces. A view has one sample in each pixel, at the same position in all pixels.
/// The positions of the additional rays differ from pixel to pixel. So an edge that runs along many pixels
/// does not have the same error in all of them.
class ExtraRays {
  public:
    /// Adds the radiance and the weight of the additional rays to `sums`. Each ray has the weight of a view,
    /// because it is a sample of the same mean.
    void trace(const PatchField& field, const PatchViews& set, const TilePlace& at, LeftToRays left,
               LightSums& sums);

  private:
    RayBatch rays_;
};

}  // namespace postlens
