// Large lists whose memory all threads take from the system.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/threads.h"

namespace postlens {

/// As values.reserve(count), but all threads write to the new memory of a list that has no elements. The
/// system clears each page when it is first written to, which takes longer than to fill it, and which a
/// single thread would do alone. Use it for lists that will be filled.
template <typename T>
void reserve_by_all(std::vector<T>& values, std::size_t count) {
    constexpr std::size_t page_bytes = 4096, task_bytes = std::size_t{1} << 21;
    const bool is_new = values.empty() && values.capacity() < count;
    values.reserve(count);
    const std::size_t bytes = count * sizeof(T), tasks = bytes / task_bytes;
    if (!is_new || tasks < 4) return;
    auto* const memory = reinterpret_cast<volatile unsigned char*>(values.data());
    parallel_for(tasks, [&](std::size_t task) {
        for (std::size_t i = task * task_bytes; i < (task + 1) * task_bytes; i += page_bytes) memory[i] = 0;
    });
}

/// As values.resize(count), with the memory of reserve_by_all.
template <typename T>
void resize_by_all(std::vector<T>& values, std::size_t count) {
    reserve_by_all(values, count);
    values.resize(count);
}

}  // namespace postlens
