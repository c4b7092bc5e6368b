// How far a picture that was made from records is from what rays would show, told by the records alone.
#pragma once

#include <vector>

#include "planner/hybrid.h"
#include "planner/tile_grid.h"

namespace postlens {

/// Squared errors of a tile, encoded values, means of the tile's pixels and of the channels.
struct PredictedTile {
    double method_mse = 0;  ///< of the picture against what the light field of the records comes to
    double bound_mse = 0;   ///< of what the records are not sure of, at most (records_bound.h)
};

struct PredictedError {
    TileGrid grid;
    std::vector<PredictedTile> tiles;  ///< 0 where nothing of the tile is in the crop
    /// PSNR of the whole picture, or of its crop, against what the light field of its records comes to.
    double predicted_db = 0;
    double bound_db = 0;      ///< the same, with all that the records are not sure of as wrong as it can be
    double unsure_share = 0;  ///< of the view samples
    int views = 0;            ///< that it was found with, beside the picture's own
};

/// Throws Error(wrong_arguments) for impulse responses without points, for another framing than the trace's,
/// for an orthographic file, and for a crop beyond the picture.
void check_predictable(const SampleHeader& header, const FocusSettings& focus);

/// Of a picture of `lens`' lens, crop and shutter, made with so many `views` (0: another method). It is
/// compared with two halves a and b of as many other views, 64 at least: the mean of (image - a)(image - b)
/// has the picture's own squared error as its expectation, since the errors of a and b are independent.
/// Throws what check_predictable and field_focus throw. Same value for any number of threads.
[[nodiscard]] PredictedError predict_error(FocusFrame& frame, const HybridSettings& lens, const Image& image,
                                           int views);

}  // namespace postlens
