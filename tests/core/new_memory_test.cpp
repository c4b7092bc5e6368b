// Lists whose memory all threads take from the system.
#include "core/new_memory.h"

#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace postlens::test::new_memory_test {
namespace {

TEST(NewMemory, IsThatOfAListOfZeros) {
    for (const std::size_t count : {0U, 1U, 1000U, (1U << 22U) + 1U}) {
        std::vector<float> list;
        resize_by_all(list, count);
        ASSERT_EQ(list.size(), count);
        EXPECT_TRUE(std::all_of(list.begin(), list.end(), [](float value) { return value == 0; }));
    }
}

TEST(NewMemory, IsRoomForSoManyElements) {
    std::vector<int> list;
    constexpr std::size_t count = std::size_t{1} << 22;
    reserve_by_all(list, count);
    EXPECT_TRUE(list.empty());
    EXPECT_GE(list.capacity(), count);
}

TEST(NewMemory, KeepsTheElementsThatAListHas) {
    std::vector<int> list{7};
    resize_by_all(list, std::size_t{1} << 22);
    EXPECT_EQ(list[0], 7);
    EXPECT_EQ(list.back(), 0);
}

}  // namespace
}  // namespace postlens::test::new_memory_test
