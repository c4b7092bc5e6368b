// Numbers with their nouns and units.
#include "core/counted.h"

#include <gtest/gtest.h>

namespace postlens::test::counted_test {
namespace {

TEST(Counted, OneHasNoS) {
    EXPECT_EQ(counted(0, "depth"), "0 depths");
    EXPECT_EQ(counted(std::size_t{1}, "depth"), "1 depth");
    EXPECT_EQ(counted(21, "depth"), "21 depths");
}

TEST(Counted, ASmallFileIsNotOfZeroMegabytes) {
    EXPECT_EQ(megabytes(2100), "0.0021 MB");
    EXPECT_EQ(megabytes(34.2e6), "34 MB");
}

}  // namespace
}  // namespace postlens::test::counted_test
