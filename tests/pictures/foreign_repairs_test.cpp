// OpenEXR files of other programs: values that are repaired, and files that are refused.
#include <cmath>
#include <cstddef>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <string_view>

#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/unmix_edges.h"
#include "tests/pictures/foreign_files.h"
#include "tests/support/file_bytes.h"

namespace postlens::test::foreign_repairs_test {
namespace {

TEST_F(ForeignPictureTest, ColoursThatAreNoNumbersGetTheMeanOfThoseAround) {
    Part part{rgbz(1, 2)};
    part.channels["R"] = {1, 2, 3, 4, 5, 6, 1, std::numeric_limits<float>::quiet_NaN(),
                          3, 4, 5, 6, 1, 2, 3, 4,
                          5, 6, 1, 2, 3, 4, 5, std::numeric_limits<float>::infinity()};
    const ForeignPicture p = read({part});
    EXPECT_TRUE(warns(p, "repaired"));
    EXPECT_EQ(p.stack(1, 1)[0].r, 2);
    EXPECT_NEAR(p.stack(5, 3)[0].r, (5 + 6 + 5) / 3.0, 1e-6);
    const ForeignPicture other = read_foreign_picture(data_folder + "nan_inf.exr", {}, {});
    EXPECT_TRUE(warns(other, "repaired"));
    for (const StackSample& s : other.samples) EXPECT_TRUE(std::isfinite(s.r + s.g + s.b));
}

TEST_F(ForeignPictureTest, ColoursWithoutFiniteNeighboursAreBlack) {
    Part part{rgbz(std::numeric_limits<float>::quiet_NaN(), 2)};
    const auto text = [&] {
        std::string out;
        for (const ForeignRepair& r : read({part}).repairs) out += r.code == "repaired" ? r.text + "\n" : "";
        return out;
    };
    EXPECT_EQ(text(), "24 samples with colours that are not finite: taken as black\n");
    // The neighbours of the first pixel have their mean, the others are black.
    part.channels["R"][0] = 1;
    EXPECT_EQ(text(),
              "3 samples with colours that are not finite: the mean of those around instead\n"
              "20 samples with colours that are not finite: taken as black\n");
}

TEST_F(ForeignPictureTest, AlphasBeyondOneAreCutOff) {
    Part part{rgbz(1, 2)};
    part.channels["A"] = even(1);
    part.channels["A"][3] = 1.5F;
    part.channels["A"][4] = std::numeric_limits<float>::quiet_NaN();
    const ForeignPicture p = read({part});
    EXPECT_TRUE(warns(p, "repaired"));
    for (const StackSample& s : p.samples) EXPECT_EQ(s.alpha, 1);
}

TEST_F(ForeignPictureTest, ARimBeforeASkyWithoutAlphaShowsBoth) {
    // A red card of 2 columns, a column that it covers by a quarter, and a blue sky. A renderer that gives
    // its sky no alpha adds the sky's light to the rim.
    Part part{rgbz(1, 2)};
    part.channels["A"] = even(1);
    for (std::size_t i = 0; i < part.channels["A"].size(); ++i) {
        const std::size_t column = i % static_cast<std::size_t>(width);
        const float card = column < 2 ? 1 : column == 2 ? 0.25F : 0;
        part.channels["A"][i] = card;
        part.channels["R"][i] = 0.8F * card;
        part.channels["G"][i] = 0;
        part.channels["B"][i] = 0.5F * (1 - card);
        part.channels["Z"][i] = card > 0 ? 2 : 1e10F;
    }
    ForeignPicture p = read({part});
    EXPECT_FALSE(warns(p, "repaired"));
    EXPECT_EQ(unmix_edges(p), 4U);
    const auto rim = p.stack(2, 1);
    ASSERT_EQ(rim.size(), 2U);
    EXPECT_EQ(rim[0].inverse_z, 0.5F);
    EXPECT_NEAR(rim[0].alpha, 0.25, 1e-6);
    EXPECT_NEAR(rim[0].r, 0.2, 1e-6);
    EXPECT_NEAR(rim[0].b, 0, 1e-6);
    EXPECT_EQ(rim[1].inverse_z, 0);
    EXPECT_NEAR(rim[1].alpha, 0, 1e-6);
    EXPECT_NEAR(rim[1].b, 0.5, 1e-6);
    // With a black sky, the rim belongs to the card alone.
    part.channels["B"] = even(0);
    ForeignPicture black = read({part});
    EXPECT_EQ(unmix_edges(black), 0U);
}

TEST_F(ForeignPictureTest, RefusesWhatIsNoWholeFile) {
    write_parts(in("whole.exr"), {{rgbz(1, 2)}});
    const std::string bytes = bytes_of(in("whole.exr"));
    for (std::size_t length = 0; length < bytes.size(); length += 7) {
        std::ofstream(in("cut.exr"), std::ios::binary) << bytes.substr(0, length);
        (void)refusal([&] { (void)read_foreign_picture(in("cut.exr"), {}, {}); });
    }
    (void)refusal([&] { (void)read_foreign_picture(in("none.exr"), {}, {}); });
    (void)refusal([&] { (void)read_foreign_picture(folder_.path(), {}, {}); });
    // A file of a few hundred bytes that states windows of 65536 x 65536 px, or windows far from each other.
    for (const char* window : {"dataWindow", "displayWindow"}) {
        std::string absurd = bytes;
        const std::size_t at = absurd.find(window) + std::string(window).size() + 1 + sizeof("box2i") + 4;
        absurd.replace(at + 8, 8, std::string("\xff\xff\x00\x00\xff\xff\x00\x00", 8));
        std::ofstream(in("absurd.exr"), std::ios::binary) << absurd;
        EXPECT_NE(
            refusal([&] { (void)read_foreign_picture(in("absurd.exr"), {}, {}); }).find("out of bounds"),
            std::string::npos);
    }
}

// The OpenEXR library always reads four bytes of an int, regardless of the stated size. It then continues in
// the middle of the next attribute and allocates 2 GB. Found by fuzzing.
TEST_F(ForeignPictureTest, RefusesAnAttributeOfAnotherSizeThanItsType) {
    const std::string shorter_int = data_folder + "damaged_int_size.exr";
    const auto damaged = [](const std::string& what) { return what.find("damaged (") != std::string::npos; };
    EXPECT_PRED1(damaged, refusal([&] { (void)read_foreign_picture(shorter_int, {}, {}); }));
    EXPECT_PRED1(damaged, refusal([&] { (void)read_image(shorter_int); }));
    const std::string huge_size = data_folder + "damaged_attribute_size.exr";
    EXPECT_PRED1(damaged, refusal([&] { (void)read_image(huge_size); }));
    // The list of channels, with a stated size one byte too small.
    write_parts(in("whole.exr"), {{rgbz(1, 2)}});
    std::string bytes = bytes_of(in("whole.exr"));
    char& size = bytes.at(bytes.find("chlist") + sizeof("chlist"));
    size = static_cast<char>(size - 1);
    std::ofstream(in("channels.exr"), std::ios::binary) << bytes;
    EXPECT_PRED1(damaged, refusal([&] { (void)read_foreign_picture(in("channels.exr"), {}, {}); }));
}

// The library allocates some rows when it opens a part, for any width that the header states. Found by
// fuzzing.
TEST_F(ForeignPictureTest, RefusesRowsWiderThanThereIsReasonFor) {
    const auto too_wide = [](const std::string& what) { return what.find("too wide") != std::string::npos; };
    EXPECT_PRED1(too_wide, refusal([] { (void)read_image(data_folder + "damaged_window.exr"); }));

    // A row of 15.7 million pixels with 3 channels takes 189 MB uncompressed, which is accepted. A part that
    // states no compression has ZIP, which packs 16 rows at a time. Tile sizes in a scanline part are
    // ignored.
    const std::string bytes = bytes_of(data_folder + "nan_inf.exr");
    const auto wide = [&](auto&& change) {
        std::string wider = bytes;
        const std::string_view window("dataWindow\0box2i\0\x10\0\0\0", 21);
        wider.replace(wider.find(window) + window.size() + 8, 4, std::string("\xff\xff\xef\0", 4));
        change(wider);
        std::ofstream(in("wide.exr"), std::ios::binary) << wider;
        return refusal([&] { (void)read_image(in("wide.exr")); });
    };
    const std::string_view compression("compression\0compression\0\1\0\0\0", 28);
    EXPECT_PRED1(std::not_fn(too_wide),
                 wide([&](std::string& b) { b[b.find(compression) + compression.size()] = '\0'; }));
    EXPECT_PRED1(too_wide, wide([&](std::string& b) { b[b.find(compression)] = 'K'; }));
    EXPECT_PRED1(too_wide, wide([&](std::string& b) {
                     b.insert(8, std::string("tiles\0tiledesc\0\x09\0\0\0\x08\0\0\0\x08\0\0\0\0", 28));
                 }));
}

// The library allocates the stated size of a deep chunk before it checks that the bytes exist. Found by
// fuzzing.
TEST_F(ForeignPictureTest, RefusesChunksOfMoreBytesThanTheFile) {
    struct Case {
        const char* file;
        std::size_t chunk;   ///< offset of the first chunk, after header and offset table
        std::size_t packed;  ///< offset of the packed size in the chunk, after position and size of counts
    };
    for (const auto& [name, chunk, packed] :
         {Case{"deep_object_ids.exr", 2816, 4 + 8}, Case{"deep_alpha.exr", 944, 4 * 4 + 8}}) {
        std::string bytes = bytes_of(data_folder + name);
        bytes.replace(chunk + packed, 8, std::string("\0\0\0\x40\0\0\0\0", 8));  // 1 GiB
        const std::string path = in(name);
        write_bytes(path, bytes);
        const std::string said = refusal([&] { (void)read_foreign_picture(path, {}, {}); });
        EXPECT_NE(said.find("a chunk is damaged (got 10737"), std::string::npos) << said;
    }
}

}  // namespace
}  // namespace postlens::test::foreign_repairs_test
