// One of several parts of a work that independent machines make.
#pragma once

#include <cstddef>

namespace postlens {

/// Share `index` of `count`, from 0 on.
struct Share {
    int index = 0, count = 1;
    /// Whether the i-th of several items, such as frames or pictures, belongs to the share, which has every
    /// `count`-th item.
    [[nodiscard]] bool has(std::size_t i) const {
        return i % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// Whether a run only joins what the shares have left in its folder.
enum class Join {
    no,      ///< makes what is missing
    whole,   ///< refuses if an item is missing
    partial  ///< leaves out what is missing
};

}  // namespace postlens
