// Layers: every surface in an accumulator of its own, laid over each other pixel by pixel in depth order.
#pragma once

#include "focus/layer_splats.h"
#include "records/image.h"

namespace postlens {

/// Pixels are worked on in blocks of so many rows, counted from the window's first.
inline constexpr int layers_block_px = 64;

/// The picture of the splats' picture window, into an image that is made to fit. In parallel; the same bits
/// for any number of threads. `wanted`: as of scatter().
void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// The same from the definition, for the whole picture at once, each response laid out in full: slow and
/// obvious, for tests.
[[nodiscard]] Image layers_reference(const LayerSplats& splats);

}  // namespace postlens
