// A vector for large lists that several threads fill.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace postlens {

/// As std::allocator, but elements that are constructed without arguments keep the values that the memory
/// has.
template <typename T>
struct UninitializedAllocator : std::allocator<T> {
    static_assert(std::is_trivially_copyable_v<T>);
    // NOLINTBEGIN(readability-identifier-naming): the standard library requires these names
    template <typename U>
    struct rebind {
        using other = UninitializedAllocator<U>;
    };
    // NOLINTEND(readability-identifier-naming)
    UninitializedAllocator() = default;
    template <typename U>
    explicit(false) UninitializedAllocator(const UninitializedAllocator<U>& /*other*/) noexcept {}
    template <typename U>
    void construct(U* /*at*/) noexcept {}
    template <typename U, typename... Values>
    void construct(U* at, Values&&... values) {
        std::construct_at(at, std::forward<Values>(values)...);
    }
};

/// A std::vector whose `resize(n)` does not write the new elements: their values are undefined until they are
/// assigned. Several threads can then write them first, and share the work of the system, which clears each
/// page of memory when it is first written. `resize(n, value)` sets the elements as usual.
template <typename T>
using BulkVector = std::vector<T, UninitializedAllocator<T>>;

}  // namespace postlens
