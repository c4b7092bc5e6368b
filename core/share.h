// A share is one of several parts of a computation. Each part can be computed on a different machine.
#pragma once

#include <cstddef>

namespace postlens {

/// Share number `index` of `count` shares. `index` begins at 0.
struct Share {
    int index = 0, count = 1;
    /// Returns true if item i, such as a frame or an image, belongs to this share. A share has every
    /// `count`-th item.
    [[nodiscard]] bool has(std::size_t i) const {
        return i % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// Whether a run computes missing items (such as images), or only joins the items that are in the folder.
/// These come from earlier runs, each of which computed one share (part) of the items.
enum class Join {
    no,      ///< computes missing items
    whole,   ///< throws an error if an item is missing
    partial  ///< leaves out missing items
};

}  // namespace postlens
