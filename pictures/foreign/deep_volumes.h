// Splits overlapping volumes of a deep pixel, so that the resulting volumes follow each other in depth.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// A decoded sample of a deep pixel: a surface if its front and back depths are equal, and otherwise a
/// volume. Colours are premultiplied by alpha.
struct DeepSample {
    float z = 0, z_back = 0;
    float r = 0, g = 0, b = 0, alpha = 0;
    std::uint32_t id = 0;
};

/// Splits volumes at the depths of surfaces, and where other volumes begin or end. Merges the parts that then
/// fill the same interval. Within a volume the density is constant. Where volumes overlap, their densities
/// and emissions add up:
///     density s = -log(1 - A) / length,  emission e = C / A s,
///     together over a length d: A = 1 - exp(-d sum s), C = A sum e / sum s,
/// where A is alpha and C colour, as in "Interpreting OpenEXR Deep Pixels". The result does not depend on the
/// order of the samples. A merged volume gets the id of its densest part. Surfaces are not changed; an opaque
/// volume counts as a surface at its front. Takes O(n log n) time.
void tidy_volumes(std::vector<DeepSample>& samples);

}  // namespace postlens
