// Resizes vectors without keeping their values.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

/// Sets the number of values of a vector, all of which will be overwritten. If values.resize(count) would
/// allocate, this function first frees the old memory instead of copying its values, and then allocates no
/// more than needed.
template <typename T>
void resize_to_overwrite(std::vector<T>& values, std::size_t count) {
    if (values.capacity() < count) values = std::vector<T>();
    values.resize(count);
}

}  // namespace postlens
