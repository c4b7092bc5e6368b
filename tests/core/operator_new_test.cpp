// core/operator_new.cpp, which this test program is linked with unless it has sanitizers.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

namespace postlens::test::operator_new_test {
namespace {

constexpr std::size_t huge_page_bytes = std::size_t{1} << 21;

TEST(OperatorNew, BlocksKeepWhatIsWrittenToThem) {
    std::vector<std::vector<unsigned char>> blocks;
    for (const std::size_t bytes :
         {std::size_t{1}, std::size_t{1000}, huge_page_bytes - 1, huge_page_bytes, 2 * huge_page_bytes + 5})
        blocks.emplace_back(bytes, static_cast<unsigned char>(blocks.size() + 1));
    // Memory that is freed and allocated again belongs to one block only.
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

// Sanitizers bring their own operator new, which ends the program if a block is too large.
#ifdef POSTLENS_HUGE_PAGES

/// The flags that the kernel states for the mapping that contains an address. Empty if it states none.
std::string flags_of_mapping(const void* address) {
    const auto wanted = reinterpret_cast<std::uintptr_t>(address);
    std::ifstream smaps("/proc/self/smaps");
    bool inside = false;
    for (std::string line; std::getline(smaps, line);) {
        std::uintptr_t begin = 0, end = 0;
        if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " ", &begin, &end) == 2)
            inside = wanted >= begin && wanted < end;
        if (inside && line.starts_with("VmFlags:")) return line + " ";
    }
    return "";
}

TEST(OperatorNew, LargeBlocksHaveHugePages) {
    if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage/enabled"))
        GTEST_SKIP() << "this kernel has no transparent huge pages";
    for (const std::size_t pages : {2, 3, 40}) {
        const std::vector<char> block(pages * huge_page_bytes);
        const std::string flags = flags_of_mapping(block.data() + block.size() / 2);
        if (flags.empty()) GTEST_SKIP() << "this kernel states no flags of mappings";
        EXPECT_NE(flags.find(" hg "), std::string::npos) << pages << " pages: " << flags;
    }
}

/// Of blocks of 200 KB, those in a mapping for which huge pages were requested.
int small_blocks_with_huge_pages(int count) {
    std::vector<std::vector<char>> blocks;
    for (int i = 0; i < count; ++i) blocks.emplace_back(200'000);
    int found = 0;
    for (const std::vector<char>& block : blocks)
        found += static_cast<int>(flags_of_mapping(block.data() + block.size() / 2).find(" hg ") !=
                                  std::string::npos);
    return found;
}

// The heap of the first thread and those of others are of different kinds. A heap's first page may be a small
// one.
TEST(OperatorNew, SmallBlocksHaveHugePagesAsWell) {
    if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage/enabled"))
        GTEST_SKIP() << "this kernel has no transparent huge pages";
    const int local = 0;
    if (flags_of_mapping(&local).empty()) GTEST_SKIP() << "this kernel states no flags of mappings";
    EXPECT_GE(small_blocks_with_huge_pages(60), 48);
    int found = 0;
    std::thread([&] { found = small_blocks_with_huge_pages(60); }).join();
    EXPECT_GE(found, 48);
}

/// The compiler may leave out a call of operator new whose block nobody uses.
void allocate(std::size_t bytes) {
    void* volatile block = ::operator new(bytes);
    ::operator delete(block);
}

TEST(OperatorNew, TooManyBytesThrow) {
    volatile std::size_t bytes = std::numeric_limits<std::size_t>::max() / 4;
    EXPECT_THROW(allocate(bytes), std::bad_alloc);
    EXPECT_EQ(::operator new(bytes, std::nothrow), nullptr);
}

int handler_calls = 0;

TEST(OperatorNew, TheHandlerIsCalledUntilThereIsNone) {
    const std::new_handler before = std::set_new_handler([] {
        if (++handler_calls == 3) std::set_new_handler(nullptr);
    });
    volatile std::size_t bytes = std::numeric_limits<std::size_t>::max() / 4;
    EXPECT_THROW(allocate(bytes), std::bad_alloc);
    EXPECT_EQ(handler_calls, 3);
    std::set_new_handler(before);
}

#endif

}  // namespace
}  // namespace postlens::test::operator_new_test
