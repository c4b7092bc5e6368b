// A share is one of several parts of a computation. Different machines can compute them.
#pragma once

#include <cstddef>

namespace postlens {

/// Share number `index` of `count` shares. `index` begins at 0.
struct Share {
    int index = 0, count = 1;
    /// Returns whether item i, such as a frame or an image, belongs to this share of the work. Every
    /// `count`-th item does.
    [[nodiscard]] bool has(std::size_t i) const {
        return i % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// Several runs may each compute a share of the items, such as images, in a folder. This setting states
/// whether a run computes missing items, or only joins the results of earlier runs.
enum class Join {
    no,      ///< computes missing items
    whole,   ///< throws an error if an item is missing
    partial  ///< leaves out missing items
};

}  // namespace postlens
