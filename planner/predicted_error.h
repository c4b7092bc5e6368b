// Estimates the error of an image from the recorded data alone, without tracing rays.
#pragma once

#include <vector>

#include "planner/hybrid.h"
#include "planner/views/tile_grid.h"

namespace postlens {

/// Estimated squared errors of an image tile's sRGB values, as means over pixels and channels.
struct PredictedTile {
    /// Squared error that is due to the method with which the image was made, for example to its limited
    /// number of lens points. It is measured relative to an image from infinitely many lens points and the
    /// same sample file.
    double method_mse = 0;
    double bound_mse = 0;  ///< upper bound of the error due to samples at edges or without a record
};

struct PredictedError {
    TileGrid grid;
    std::vector<PredictedTile> tiles;  ///< 0 for tiles outside the crop
    /// Predicted error of the image, or of its crop, as PSNR in dB. The image is compared with the mean of
    /// infinitely many views (images from different lens points), made from the same sample file. So errors
    /// of the sample file itself do not count.
    double predicted_db = 0;
    double bound_db = 0;      ///< the bound as PSNR; it counts view samples that the records do not determine
    double unsure_share = 0;  ///< share of view samples that the records do not determine
    int views = 0;            ///< number of views drawn for the estimate
};

/// Throws Error(wrong_arguments) if the error of an image cannot be predicted:
/// - its blur cannot be made by averaging images from lens points (`diffraction`, `lens:`)
/// - its field of view differs from that of the trace (`framing` is not `keep`)
/// - the file is orthographic
/// - the crop exceeds the image
void check_predictable(const SampleHeader& header, const FocusSettings& focus);

/// Estimates the error of `image`, which was made for the lens, crop and shutter of `lens`. `views` is its
/// number of views (images from different lens points), or 0 if its method has no views.
///
/// Draws at least 64 more views, from other lens points, which form two independent images a and b. The mean
/// of (image - a)(image - b) over pixels then estimates the squared error of `image`.
///
/// Throws the errors of check_predictable and field_focus. The result is bit-identical for any number of
/// threads.
[[nodiscard]] PredictedError predict_error(FocusFrame& frame, const HybridSettings& lens, const Image& image,
                                           int views);

}  // namespace postlens
