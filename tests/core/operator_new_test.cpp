// core/operator_new.cpp, which this test program is linked with.
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <new>
#include <vector>

namespace postlens {
namespace {

constexpr std::size_t huge_page_bytes = std::size_t{1} << 21;

bool starts_huge_page(const void* block) {
    return reinterpret_cast<std::uintptr_t>(block) % huge_page_bytes == 0;
}

#ifdef POSTLENS_HUGE_PAGES
TEST(OperatorNew, LargeBlocksStartAtAHugePage) {
    for (const std::size_t bytes : {huge_page_bytes, 3 * huge_page_bytes + 1, 40 * huge_page_bytes}) {
        const std::vector<char> block(bytes);
        EXPECT_TRUE(starts_huge_page(block.data())) << bytes << " bytes";
    }
    // Two blocks of half a page: at most one of them can start at a page.
    const std::vector<char> a(huge_page_bytes / 2), b(huge_page_bytes / 2);
    EXPECT_FALSE(starts_huge_page(a.data()) && starts_huge_page(b.data()));
}
#endif

TEST(OperatorNew, BlocksKeepWhatIsWrittenToThem) {
    std::vector<std::vector<unsigned char>> blocks;
    for (const std::size_t bytes :
         {std::size_t{1}, std::size_t{1000}, huge_page_bytes - 1, huge_page_bytes, 2 * huge_page_bytes + 5})
        blocks.emplace_back(bytes, static_cast<unsigned char>(blocks.size() + 1));
    // Memory that is freed and taken again is another block's.
    blocks[3] = std::vector<unsigned char>(huge_page_bytes + 7, 9);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const unsigned char expected = i == 3 ? 9 : static_cast<unsigned char>(i + 1);
        for (const unsigned char value : blocks[i]) ASSERT_EQ(value, expected) << "block " << i;
    }
}

TEST(OperatorNew, NoBytesAreABlockOfTheirOwn) {
    const auto a = std::make_unique<char[]>(0), b = std::make_unique<char[]>(0);
    EXPECT_NE(a.get(), nullptr);
    EXPECT_NE(a.get(), b.get());
}

TEST(OperatorNew, TooManyBytesThrow) {
    volatile std::size_t bytes = std::numeric_limits<std::size_t>::max() / 4;
    EXPECT_THROW(static_cast<void>(::operator new(bytes)), std::bad_alloc);
    EXPECT_EQ(::operator new(bytes, std::nothrow), nullptr);
}

int handler_calls = 0;

TEST(OperatorNew, TheHandlerIsCalledUntilItGivesUp) {
    const std::new_handler before = std::set_new_handler([] {
        if (++handler_calls == 3) std::set_new_handler(nullptr);
    });
    volatile std::size_t bytes = std::numeric_limits<std::size_t>::max() / 4;
    EXPECT_THROW(static_cast<void>(::operator new(bytes)), std::bad_alloc);
    EXPECT_EQ(handler_calls, 3);
    std::set_new_handler(before);
}

}  // namespace
}  // namespace postlens
