// Splits overlapping volumes of a deep pixel into volumes that follow each other in depth.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// A decoded sample of a deep pixel. It is a surface if its front and back depths are equal, or else a
/// volume. Colours are premultiplied by alpha.
struct DeepSample {
    float z = 0, z_back = 0;
    float r = 0, g = 0, b = 0, alpha = 0;
    std::uint32_t id = 0;
};

/// Splits volumes at the depths of surfaces and at the depths where other volumes begin or end. Then merges
/// all volumes that fill the same interval of depth. The density within a volume is constant. Where volumes
/// overlap, their densities and emissions are added. The formulas are those of "Interpreting OpenEXR Deep
/// Pixels", where A is the alpha of a volume, C its colour and d its length:
///     density s = -log(1 - A) / d, emission e = C s / A,
///     merged volume: A = 1 - exp(-d sum s), C = A sum e / sum s.
/// A merged volume gets the id of its densest component. Surfaces are not changed. An opaque volume counts as
/// a surface at its front. The result does not depend on the order of the samples. Takes O(n log n) time.
void tidy_volumes(std::vector<DeepSample>& samples);

}  // namespace postlens
