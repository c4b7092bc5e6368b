// Provides memory for large vectors faster. When a memory page is written to for the first time, the
// operating system must provide it, which is slow. Therefore, all threads write to the pages of the new
// memory in parallel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/threads.h"

namespace postlens {

/// Like values.reserve(count). But if the vector is empty, all threads write to its new memory in parallel,
/// because the first write to each memory page is slow. Use it for vectors that will be filled completely.
template <typename T>
void reserve_by_all(std::vector<T>& values, std::size_t count) {
    constexpr std::size_t page_bytes = 4096, task_bytes = std::size_t{1} << 21;
    const bool is_new = values.empty() && values.capacity() < count;
    values.reserve(count);
    const std::size_t bytes = count * sizeof(T), tasks = bytes / task_bytes;
    if (!is_new || tasks < 2) return;
    auto* const memory = reinterpret_cast<volatile unsigned char*>(values.data());
    parallel_for(tasks, [&](std::size_t task) {
        for (std::size_t i = task * task_bytes; i < (task + 1) * task_bytes; i += page_bytes) memory[i] = 0;
    });
}

/// Like values.resize(count), but allocates with reserve_by_all.
template <typename T>
void resize_by_all(std::vector<T>& values, std::size_t count) {
    reserve_by_all(values, count);
    values.resize(count);
}

}  // namespace postlens
