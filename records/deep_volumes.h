// Volumes of a deep pixel that overlap, made into such that follow each other.
#pragma once

#include <cstdint>
#include <vector>

namespace postlens {

/// A sample of a deep pixel as the file has it, decoded: a surface where it ends where it begins, else a
/// volume. Colours are premultiplied.
struct DeepSample {
    float z = 0, z_back = 0;
    float r = 0, g = 0, b = 0, alpha = 0;
    std::uint32_t id = 0;
};

/// Cuts volumes where others begin or end, and makes one of those that fill the same interval. Within a
/// volume of alpha A every equal way lets through by the same share; two in one place hold back, and shine,
/// as much as both by themselves:
///     density s = -log(1 - A) / length,  emission e = C / A s,
///     together over a length d: A = 1 - exp(-d sum s), C = A sum e / sum s,
/// which is the mixture of "Interpreting OpenEXR Deep Pixels". Whatever their order, the result is the same.
/// The id is that of the densest. Surfaces, and opaque volumes, which are surfaces where they begin, stay as
/// they are. Nothing changes where no two volumes overlap. In O(n log n).
void tidy_volumes(std::vector<DeepSample>& samples);

}  // namespace postlens
