// The method `layers`. It scatters each surface separately, then composites the surfaces of each pixel in
// depth order.
#pragma once

#include "focus/layers/layer_splats.h"
#include "pictures/image.h"

namespace postlens {

/// Height of the blocks in which images are computed, in px.
inline constexpr int layers_block_px = 64;

/// Computes the pixels of the window splats.picture(), in parallel, and resizes `image` to this window.
/// Blocks outside `wanted` are skipped. The result is bit-identical for any number of threads.
void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Returns how many sums layers() computes for the whole image: one per part of a surface and pixel that it
/// may reach. They take most of the time if much is widely blurred.
[[nodiscard]] double layer_sums(const LayerSplats& splats);

/// Computes the same image as layers(), by evaluating every impulse response at every pixel. It is a slow
/// reference for tests.
[[nodiscard]] Image layers_reference(const LayerSplats& splats);

}  // namespace postlens
