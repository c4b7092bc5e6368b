// Which rows a share has.
#include "apps/share.h"

#include <gtest/gtest.h>

namespace postlens::test::share_test {
namespace {

TEST(Shares, RowsAreEachInOneShareAndDifferByOne) {
    for (const int height : {1, 7, 100, 1080}) {
        for (const int count : {1, 2, 3, 7}) {
            if (count > height) continue;
            int next = 3;
            for (int i = 0; i < count; ++i) {
                const Crop rows = rows_of_share({i, count}, Crop{2, 3, 5, height}, 20, height + 5);
                EXPECT_EQ(rows.y, next);
                EXPECT_GE(rows.height, height / count);
                EXPECT_LE(rows.height, height / count + 1);
                next += rows.height;
            }
            EXPECT_EQ(next, 3 + height);
        }
    }
}

}  // namespace
}  // namespace postlens::test::share_test
