// Reads numbers from the buffers of a glTF document.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "scene/gltf/gltf_document.h"

namespace postlens {

struct GltfValues {
    std::size_t count = 0;
    std::size_t components = 1;  ///< of one element: 1 for a SCALAR, 3 for a VEC3, ...
    std::vector<float> values;   ///< element by element, finite; normalised integers in [-1, 1] or [0, 1]
};

/// Reads accessors and limits their total size, because many accessors may share one small buffer.
class GltfAccessors {
  public:
    explicit GltfAccessors(const GltfDocument& document) : document_(document) {}

    /// The elements of an accessor, whose index must be in range. Sparse elements are filled in. `place` is
    /// the JSON object that refers to the accessor, for error messages. Throws Error(invalid_input) if the
    /// number of components is not one of `components`, if elements lie outside of the buffer view, or if a
    /// number is not finite.
    [[nodiscard]] GltfValues floats(std::size_t index, std::initializer_list<std::size_t> components,
                                    const JsonPlace& place);
    /// Unsigned integers of a SCALAR accessor, each less than `limit`.
    [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t index, std::size_t limit,
                                                     const JsonPlace& place);

  private:
    struct Layout;
    [[nodiscard]] Layout layout(std::size_t index, const JsonPlace& place);
    void spend(std::size_t numbers, const JsonPlace& place);
    void fill_sparse(const JsonPlace& accessor, const Layout& layout, GltfValues& out);

    const GltfDocument& document_;
    std::size_t spent_ = 0;
};

}  // namespace postlens
