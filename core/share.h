// A share is one of several parts of a computation. Different machines can compute them.
#pragma once

#include <cstddef>

namespace postlens {

/// Share number `index` of `count` shares. `index` begins at 0.
struct Share {
    int index = 0, count = 1;
    /// Returns true if item i of the work, for example a frame or an image, belongs to this share. Every
    /// `count`-th item does, starting with item `index`.
    [[nodiscard]] bool has(std::size_t i) const {
        return i % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// States what a run does about items, such as the images of a sweep, whose results are missing in the output
/// folder. Several runs that divide the items of a command write their results to this folder. A run either
/// computes the missing items, or only joins the existing results.
enum class Join {
    no,      ///< computes missing items
    whole,   ///< throws an error if an item is missing
    partial  ///< leaves out missing items
};

}  // namespace postlens
