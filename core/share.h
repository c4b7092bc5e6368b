// A share: one of several parts of a computation. An independent machine computes each part.
#pragma once

#include <cstddef>

namespace postlens {

/// Share `index` of `count`, from 0 on.
struct Share {
    int index = 0, count = 1;
    /// True if item i, such as a frame or an image, belongs to this share. A share has every `count`-th item.
    [[nodiscard]] bool has(std::size_t i) const {
        return i % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// Whether a run only joins the results of earlier runs, one per share, in its folder.
enum class Join {
    no,      ///< computes missing items
    whole,   ///< throws an error if an item is missing
    partial  ///< leaves out missing items
};

}  // namespace postlens
