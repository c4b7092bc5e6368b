// Attributes in the header of an OpenEXR file: their sizes and bounds.
#include "pictures/exr/exr_attributes.h"

#include <OpenEXR/ImfStandardAttributes.h>
#include <cstdint>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::exr_attributes_test {
namespace {

// The OpenEXR library reads four bytes beyond the end of a manifest.
TEST(ExrAttribute, NothingShortFollowsAManifest) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "manifest.exr";
    const auto with = [&](const std::string& name) {
        std::string bytes{"\x76\x2f\x31\x01\x02\0\0\0", 8};
        const auto add = [&](const std::string& key, const std::string& type, const std::string& value) {
            bytes +=
                key + '\0' + type + '\0' + static_cast<char>(value.size()) + std::string(3, '\0') + value;
        };
        add("idManifest", "idmanifest", "12345678");
        if (!name.empty()) add(name, "compression", std::string(1, '\0'));
        std::ofstream(path, std::ios::binary) << bytes + '\0';
        check_exr_headers(path);
    };
    EXPECT_NO_THROW(with("lineOrder"));
    EXPECT_NO_THROW(with("five5"));
    EXPECT_THROW(with("four"), Error);
    EXPECT_THROW(with("n"), Error);
    EXPECT_THROW(with(""), Error);
}

// Without a data window, the OpenEXR library assumes a small one, but allocates tiles of the stated size.
TEST(ExrAttribute, TilesAreBoundedWithoutAWindow) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "tiles.exr";
    const auto with = [&](std::uint8_t third_byte) {
        std::string bytes{"\x76\x2f\x31\x01\x02\x02\0\0", 8};
        const auto add = [&](const std::string& key, const std::string& type, const std::string& value) {
            bytes +=
                key + '\0' + type + '\0' + static_cast<char>(value.size()) + std::string(3, '\0') + value;
        };
        add("channels", "chlist", std::string("R\0\x01\0\0\0\0\0\0\0\x01\0\0\0\x01\0\0\0\0", 19));
        add("tiles", "tiledesc",
            std::string("\x40\0", 2) + static_cast<char>(third_byte) + std::string("\0\x00\x04\0\0\0", 6));
        std::ofstream(path, std::ios::binary) << bytes + '\0';
        check_exr_headers(path);
    };
    EXPECT_NO_THROW(with(0));
    EXPECT_THROW(with(0x36), Error);
}

TEST(ExrAttribute, FillsItsSize) {
    using B = std::vector<std::uint8_t>;
    EXPECT_TRUE(fills_its_size("int", B(4)));
    EXPECT_FALSE(fills_its_size("int", B(1)));
    EXPECT_FALSE(fills_its_size("m44f", B(60)));
    EXPECT_TRUE(fills_its_size("string", B(7)));
    EXPECT_TRUE(fills_its_size("of.another.program", B(7)));
    EXPECT_TRUE(fills_its_size("stringvector", B{2, 0, 0, 0, 'a', 'b', 0, 0, 0, 0}));
    EXPECT_TRUE(fills_its_size("stringvector", B{}));
    EXPECT_FALSE(fills_its_size("stringvector", B{2, 0, 0, 0, 'a'}));
    EXPECT_FALSE(fills_its_size("stringvector", B{255, 255, 255, 255, 'a'}));
    EXPECT_TRUE(fills_its_size("preview", B{1, 0, 0, 0, 1, 0, 0, 0, 9, 9, 9, 9}));
    EXPECT_FALSE(fills_its_size("preview", B{1, 0, 0, 0, 2, 0, 0, 0, 9, 9, 9, 9}));
    EXPECT_FALSE(fills_its_size("preview", B{255, 255, 255, 255, 255, 255, 255, 255, 9, 9, 9, 9}));
    EXPECT_TRUE(fills_its_size("chlist", B{0}));
    EXPECT_FALSE(fills_its_size("chlist", B{}));
    EXPECT_FALSE(fills_its_size("chlist", B{'R', 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));
    EXPECT_TRUE(fills_its_size("chlist", B{'R', 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0}));
    EXPECT_FALSE(fills_its_size("chlist", B{0, 0}));
}

}  // namespace
}  // namespace postlens::test::exr_attributes_test
