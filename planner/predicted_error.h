// How far a picture is expected to be from the truth, by the records that it was made from alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/hybrid.h"
#include "planner/tile_grid.h"

namespace postlens {

/// Expected squared errors of a tile, encoded values, means of the tile's pixels and of the channels.
struct PredictedTile {
    double method_mse = 0;  ///< of the picture against what the light field of the records comes to
    double floor_mse = 0;   ///< of the records' density
    double hidden_mse = 0;  ///< of what no record shows, and of what W misplaces
    [[nodiscard]] double mse() const { return method_mse + floor_mse + hidden_mse; }
};

struct PredictedError {
    TileGrid grid;
    std::vector<PredictedTile> tiles;  ///< 0 where nothing of the tile is in the crop
    double predicted_db = 0;           ///< PSNR of the whole picture, or of its crop
    int views = 0;                     ///< that it was found with, beside the picture's own
};

/// A picture that was made of the records.
struct MadeOfRecords {
    const Image* image = nullptr;
    /// What made it; not `automatic`, which has an expectation of its own.
    FocusMethod method = FocusMethod::scatter;
    int views = 0;  ///< of `lightfield` and `hybrid`
    /// Of `hybrid`: what each pixel is by, as HybridResult::what has it. Empty: by the method.
    std::span<const std::uint8_t> what;
};

/// Throws Error(wrong_arguments) for impulse responses without points, for another framing than the trace's,
/// for an orthographic file, and for a crop beyond the picture.
void check_predictable(const SampleHeader& header, const FocusSettings& focus);

/// What is expected of a picture of `lens`' lens, crop and shutter. Of the light field and hybrid: the noise
/// of their views, told by two sets of 8 others; of every other method how far it is from two sets of 32
/// views, (image - a)(image - b), of which their own noise takes no part but for what both have alike. To
/// that comes what the records lack: their density, and light that no record shows or W misplaces. What no
/// record tells, such as shading that changes over the lens, is not in it. Throws what
/// check_predictable and field_focus throw. Same value for any number of threads.
[[nodiscard]] PredictedError predict_error(FocusFrame& frame, const HybridSettings& lens,
                                           const MadeOfRecords& made);

}  // namespace postlens
