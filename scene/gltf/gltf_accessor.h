// Reads numbers from the buffers of a glTF document.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "scene/gltf/gltf_document.h"

namespace postlens {

struct GltfValues {
    std::size_t count = 0;
    std::size_t components = 1;  ///< number of values per element: 1 for a SCALAR, 3 for a VEC3, ...
    /// Components of all elements of the accessor (a typed array of a glTF document), one element after the
    /// other. All are finite. Integers that the file declares as normalised are scaled to [0, 1] if unsigned,
    /// or to [-1, 1] if signed.
    std::vector<float> values;
};

/// Reads accessors (typed arrays of a glTF document) and limits their total size.
/// Otherwise many accessors of one small buffer could fill the memory.
class GltfAccessors {
  public:
    explicit GltfAccessors(const GltfDocument& document) : document_(document) {}

    /// Returns the elements of an accessor (array of numbers) of the glTF file. `index` is its number in the
    /// file, and must be in range. Sparse accessors are supported. `place` is the JSON object that refers to
    /// the accessor; error messages name it. Throws Error(invalid_input):
    /// - if the number of components is not one of `components`
    /// - if elements lie outside the buffer view
    /// - if a number is not finite
    [[nodiscard]] GltfValues floats(std::size_t index, std::initializer_list<std::size_t> components,
                                    const JsonPlace& place);
    /// Returns the unsigned integers of a glTF accessor (array) whose elements are single numbers (type
    /// SCALAR). Throws Error(invalid_input) if a value is `limit` or more. `place` is the JSON object that
    /// refers to the accessor; error messages name it.
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
