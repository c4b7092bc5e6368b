// Images of other programs in the viewer: depths, ids, and what a pixel consists of.
#include "apps/view/viewed_frame.h"

#include <OpenEXR/ImfStringAttribute.h>
#include <bit>
#include <cmath>
#include <limits>

#include "tests/pictures/foreign_files.h"

namespace postlens::test::viewed_frame_test {
namespace {

using Json = nlohmann::ordered_json;

/// A plane with one value in the columns before `from`, and another in the others.
Plane halves(float left, float right, int from = width / 2) {
    Plane out;
    for (int i = 0; i < width * height; ++i) out.push_back(i % width < from ? left : right);
    return out;
}

float bits(std::uint32_t id) {
    return std::bit_cast<float>(id);
}

class ViewedFrames : public testing::Test {
  protected:
    std::string in(const std::string& name) { return (folder_.path() / name).string(); }
    std::unique_ptr<ViewedFrame> view(const Part& part) {
        write_parts(in("a.exr"), {part});
        return open_viewed_frame(in("a.exr"));
    }
    TemporaryFolder folder_;
};

/// A card at 2 m, left, before a wall at 8 m.
Part card_and_wall() {
    return {.channels = {{"R", halves(1, 0.5F)},
                         {"G", halves(1, 0.5F)},
                         {"B", halves(1, 0.5F)},
                         {"Z", halves(2, 8)},
                         {"id", halves(7, 9)}}};
}

TEST_F(ViewedFrames, DepthsOfAFlatImageAreThoseOfItsDisplayWindow) {
    Part part = card_and_wall();
    // One column more than the file stores on the left, and one less on the right.
    part.more = [](Imf::Header& h) { h.displayWindow() = {{-1, 0}, {width - 2, height - 1}}; };
    const auto frame = view(part);
    const Json facts = frame->facts();
    EXPECT_EQ(facts.at("width"), width);
    EXPECT_EQ(facts.at("nearest_m"), 2.0);
    EXPECT_EQ(facts.at("focal_length_mm"), 50);  // as focus assumes it
    EXPECT_EQ(facts.at("pixel_pitch_mm"), 6);
    EXPECT_EQ(facts.at("film_distance_from_focal_length"), true);
    EXPECT_TRUE(facts.at("f_number").is_null());
    EXPECT_EQ(frame->kept(), nullptr);
    const ImageDepths depths = frame->depths();
    ASSERT_EQ(depths.inverse_per_m.size(), static_cast<std::size_t>(width * height));
    const std::vector<float> row{0, 0.5F, 0.5F, 0.5F, 0.125F, 0.125F};
    for (std::size_t i = 0; i < depths.inverse_per_m.size(); ++i) {
        EXPECT_EQ(depths.inverse_per_m[i], row[i % row.size()]);
        EXPECT_EQ(depths.ids[i],
                  i % row.size() == 0 ? 0 : std::bit_cast<std::uint32_t>(i % row.size() < 4 ? 7.0F : 9.0F));
    }
    const Json nothing = frame->pixel(0.5, 1.5, {});
    EXPECT_TRUE(nothing.at("nodes").empty());
    EXPECT_TRUE(nothing.at("clicked").is_null());
    for (const double x : {-0.5, 6.0, 1e9, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW((void)frame->pixel(x, 1, {}), Error) << x;
}

TEST_F(ViewedFrames, APixelHasDepthIdAndCircle) {
    const auto frame = view(card_and_wall());
    LensOptions lens;
    EXPECT_FALSE(frame->pixel(5.5, 0.5, lens).at("nodes").at(0).contains("coc_px"));
    lens.f_number = 2;
    lens.focus_m = 2;
    const auto pixel = [&] { return frame->pixel(5.5, 0.5, lens); };
    const Json node = pixel().at("nodes").at(0);
    EXPECT_EQ(node.at("share"), 1.0);
    EXPECT_EQ(node.at("z_m"), 8.0);
    EXPECT_EQ(node.at("name"), "9");
    // The CoC is (d / pitch) (F / n) |1/s - 1/z'|, with a pitch of 6 mm.
    EXPECT_NEAR(node.at("coc_px").at(0).get<double>(), 50.0 / 6 * (0.05 / 2) * (0.5 - 0.125), 1e-9);
    // The file does not state the distance of the film, which is then the focal length, as focus assumes it.
    lens.focal_length_mm = 100;
    EXPECT_NEAR(pixel().at("clicked").at("coc_px").at(0).get<double>(), 100.0 / 6 * (0.1 / 2) * (0.5 - 0.125),
                1e-9);
    EXPECT_EQ(pixel().at("clicked").at("focus_m"), 8.0);
    for (const double wrong : {0.0, -1.0}) {
        lens.f_number = wrong;
        EXPECT_THROW((void)pixel(), Error);
    }
}

TEST_F(ViewedFrames, DepthsOfADeepImageAreWhereItsAlphaReachesOneHalf) {
    write_deep_pixel(
        in("deep.exr"),
        {{0.2F, 0.2F, 0.2F, 0.25F, 1, 1}, {0.4F, 0.4F, 0.4F, 0.5F, 2, 2}, {0.8F, 0.8F, 0.8F, 1, 4, 4}});
    const auto frame = open_viewed_frame(in("deep.exr"));
    EXPECT_EQ(frame->depths().inverse_per_m, std::vector<float>{0.5F});
    const Json json = frame->pixel(0.5, 0.5, {});
    EXPECT_EQ(json.at("clicked").at("focus_m"), 2.0);
    // Contributions: 0.2; 0.75 of 0.4; 0.75 * 0.5 of 0.8. The last two are equal.
    ASSERT_EQ(json.at("nodes").size(), 3U);
    const std::vector<std::pair<double, double>> wanted{{2, 3.0 / 8}, {4, 3.0 / 8}, {1, 2.0 / 8}};
    for (std::size_t i = 0; i < 3; ++i) {
        double z = 0, share = 0;
        for (const Json& node : json.at("nodes")) {
            if (node.at("z_m").get<double>() == wanted[i].first) {
                z = node.at("z_m").get<double>();
                share = node.at("share").get<double>();
            }
        }
        EXPECT_EQ(z, wanted[i].first);
        EXPECT_NEAR(share, wanted[i].second, 1e-6);
    }
    EXPECT_EQ(json.at("nodes").at(2).at("z_m"), 1.0);
}

TEST_F(ViewedFrames, APixelThatIsMostlyTransparentIsInfinitelyFar) {
    write_deep_pixel(in("deep.exr"), {{0.2F, 0.2F, 0.2F, 0.25F, 1, 1}});
    const auto frame = open_viewed_frame(in("deep.exr"));
    EXPECT_EQ(frame->depths().inverse_per_m, std::vector<float>{0.0F});
    const Json json = frame->pixel(0.5, 0.5, {});
    EXPECT_EQ(json.at("nodes").size(), 1U);
    EXPECT_TRUE(json.at("clicked").at("focus_m").is_null());
    EXPECT_TRUE(frame->facts().at("nearest_m").is_null());
}

TEST_F(ViewedFrames, ObjectsHaveTheNamesOfTheManifest) {
    const std::uint32_t bunny = cryptomatte_id("bunny"), bush = cryptomatte_id("bush");
    Part part = card_and_wall();
    part.channels.erase("id");
    part.channels["CryptoObject00.R"] = halves(bits(bunny), bits(bush));
    part.channels["CryptoObject00.G"] = halves(1, 1);
    part.channels["CryptoObject00.B"] = halves(0, 0);
    part.channels["CryptoObject00.A"] = halves(0, 0);
    // The last column of the card shows half of each.
    for (std::size_t i = 2; i < part.channels["R"].size(); i += width) {
        for (const char* c : {"R", "G", "B"}) part.channels[c][i] = 0.75F;
        part.channels["CryptoObject00.G"][i] = 0.5F;
        part.channels["CryptoObject00.B"][i] = bits(bush);
        part.channels["CryptoObject00.A"][i] = 0.5F;
    }
    part.more = [](Imf::Header& h) {
        for (const auto& [key, text] : std::map<std::string, std::string>{
                 {"name", "CryptoObject"}, {"manifest", R"({"bunny":"13851a76"})"}})
            h.insert("cryptomatte/1234567/" + key, Imf::StringAttribute(text));
    };
    const auto frame = view(part);
    EXPECT_EQ(frame->pixel(0.5, 0.5, {}).at("nodes").at(0).at("name"), "bunny");
    EXPECT_EQ(frame->pixel(5.5, 0.5, {}).at("nodes").at(0).at("name"), "f763d090");  // not in the manifest
    const Json edge = frame->pixel(2.5, 1.5, {}).at("nodes");
    ASSERT_EQ(edge.size(), 2U);
    EXPECT_EQ(edge.at(0).at("name"), "bunny");
    EXPECT_EQ(edge.at(0).at("z_m"), 2.0);
    EXPECT_NEAR(edge.at(0).at("share").get<double>(), 2.0 / 3, 1e-6);
    EXPECT_EQ(edge.at(1).at("z_m"), 8.0);
    EXPECT_EQ(edge.at(1).at("id"), bush);
}

}  // namespace
}  // namespace postlens::test::viewed_frame_test
