// Ids in images of other programs: channels, Cryptomattes, and edges that are unmixed by their coverage.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>

#include "core/error.h"
#include "motionblur/vectors/vector_frame.h"
#include "pictures/foreign/cryptomatte.h"
#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/unmix_edges.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::foreign_ids_test {
namespace {

constexpr int width = 5, height = 3;

using Plane = std::vector<float>;
struct Channel {
    Plane values;  ///< integers are stored as their bits
    Imf::PixelType type = Imf::FLOAT;
};
struct Part {
    std::map<std::string, Channel> channels;
    std::string name;
    std::map<std::string, std::string> texts;
    Imf::Compression compression = Imf::ZIP_COMPRESSION;
};

Plane even(float v) {
    return Plane(static_cast<std::size_t>(width * height), v);
}
Plane bits(std::uint32_t id) {
    return even(std::bit_cast<float>(id));
}

Part colours() {
    return {{{"R", {even(0.75F)}}, {"G", {even(0.5F)}}, {"B", {even(0.25F)}}, {"Z", {even(4)}}}, "", {}};
}

void write_parts(const std::string& path, std::vector<Part> parts) {
    std::vector<Imf::Header> headers;
    for (const Part& p : parts) {
        Imf::Header h(width, height);
        h.setType(Imf::SCANLINEIMAGE);
        h.compression() = p.compression;
        if (!p.name.empty()) h.setName(p.name);
        for (const auto& [name, c] : p.channels) h.channels().insert(name, Imf::Channel(c.type));
        for (const auto& [name, text] : p.texts) h.insert(name, Imf::StringAttribute(text));
        headers.push_back(h);
    }
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::FrameBuffer frame;
        std::vector<std::vector<half>> halves;
        for (auto& [name, c] : parts[i].channels) {
            if (c.type == Imf::HALF) {
                halves.emplace_back(c.values.begin(), c.values.end());
                frame.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.back().data()),
                                              sizeof(half), sizeof(half) * width));
            } else {
                frame.insert(name, Imf::Slice(c.type, reinterpret_cast<char*>(c.values.data()), sizeof(float),
                                              sizeof(float) * width));
            }
        }
        Imf::OutputPart out(file, static_cast<int>(i));
        out.setFrameBuffer(frame);
        out.writePixels(height);
    }
}

/// A part with a Cryptomatte of two ranks in one layer of channels. All pixels show one surface.
Part with_matte(const std::string& name = "CryptoObject") {
    Part p = colours();
    p.channels[name + "00.R"] = {bits(cryptomatte_id("bunny"))};
    p.channels[name + "00.G"] = {even(1)};
    p.channels[name + "00.B"] = {even(0)};
    p.channels[name + "00.A"] = {even(0)};
    p.texts = {{"cryptomatte/1234567/name", name},
               {"cryptomatte/1234567/hash", "MurmurHash3_32"},
               {"cryptomatte/1234567/conversion", "uint32_to_float32"},
               {"cryptomatte/1234567/manifest", R"({"bunny":"13851a76"})"}};
    return p;
}

class ForeignIds : public testing::Test {
  protected:
    std::string in(const std::string& name) { return (folder_.path() / name).string(); }
    ForeignPicture read(const std::vector<Part>& parts, const ForeignChoice& choice = {}) {
        write_parts(in("a.exr"), parts);
        return read_foreign_picture(in("a.exr"), choice, {});
    }
    static int warnings(const ForeignPicture& p) {
        return static_cast<int>(std::count_if(p.repairs.begin(), p.repairs.end(),
                                              [](const ForeignRepair& r) { return r.code == "ids"; }));
    }
    TemporaryFolder folder_;
};

TEST(CryptomatteId, IsThatOfTheSpecificationsOwnPictures) {
    // The values are from manifests that other programs wrote.
    EXPECT_EQ(cryptomatte_id("bunny"), 0x13851a76U);
    EXPECT_EQ(cryptomatte_id("default"), 0x42c9679fU);
    EXPECT_EQ(cryptomatte_id("bush"), 0xf763d090U);
    EXPECT_EQ(cryptomatte_id("flowerA.flowerA_petal1.:1015"), 0x914754e4U);
    EXPECT_EQ(cryptomatte_id("flowerA.flowerA_petal10.:3594"), 0x0086fc22U);
    EXPECT_EQ(cryptomatte_id("flowerA.flowerA_petal1.:84"), 0x49050927U);
    // The hash of the empty name is 0, which Cryptomatte replaces by a normal float.
    EXPECT_EQ(cryptomatte_id(""), 0x00800000U);
}

TEST(CryptomatteId, ManifestsThatAreNone) {
    EXPECT_EQ(manifest_names(R"({"bunny":"13851a76","bush":"f763d090"})"),
              (std::vector<std::string>{"bunny", "bush"}));
    EXPECT_EQ(manifest_names("{}"), std::vector<std::string>{});
    for (const char* broken : {"", "{", "[1]", "null", R"({"a":1})", R"({"a":"xyz"})", R"({"a":"123456789"})",
                               "{\"a\":\"1\"", "{\"\xff\":\"1\"}"})
        EXPECT_EQ(manifest_names(broken), std::nullopt) << broken;
    EXPECT_EQ(manifest_names("{\"" + std::string(1 << 20, 'n') + "\":\"1\"}")->size(), 1U);
    EXPECT_EQ(manifest_names(std::string(1 << 20, '[')), std::nullopt);
}

TEST_F(ForeignIds, OfChannelsByTheirNames) {
    for (const char* name : {"id", "ID", "objectId", "ObjectID", "IndexOB.X"}) {
        Part part = colours();
        part.channels[name] = {even(7)};
        const ForeignPicture p = read({part});
        EXPECT_EQ(p.channels.id, name);
        EXPECT_EQ(p.stack(1, 1)[0].id, std::bit_cast<std::uint32_t>(7.0F));
    }
    // Integers are kept exactly. 0 and NaN stand for no id.
    Part part = colours();
    part.channels["id"] = {bits(0xFFFFFFFEU), Imf::UINT};
    EXPECT_EQ(read({part}).stack(1, 1)[0].id, 0xFFFFFFFEU);
    for (const float none : {0.0F, -0.0F, std::numeric_limits<float>::quiet_NaN()}) {
        part.channels["id"] = {even(none)};
        EXPECT_EQ(read({part}).stack(1, 1)[0].id, 0U);
    }
    // Ids in another part, in a channel given by name, and no ids.
    Part other{{{"IndexOB.X", {even(3)}}}, "index", {}};
    part = colours();
    part.name = "rgb";
    part.channels["mask"] = {even(9)};
    EXPECT_EQ(read({part, other}).stack(4, 2)[0].id, std::bit_cast<std::uint32_t>(3.0F));
    EXPECT_EQ(read({part, other}, {.ids = "mask"}).stack(4, 2)[0].id, std::bit_cast<std::uint32_t>(9.0F));
    EXPECT_EQ(read({part, other}, {.ids = "none"}).stack(4, 2)[0].id, 0U);
    try {
        (void)read({part, other}, {.ids = "nothing such"});
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::invalid_input);
        EXPECT_NE(std::string(e.what()).find("no ids nothing such (got B, G, R"), std::string::npos)
            << e.what();
    }
}

TEST_F(ForeignIds, OfACryptomatteByItsShares) {
    Part part = with_matte();
    const std::uint32_t bunny = cryptomatte_id("bunny"), bush = cryptomatte_id("bush");
    const auto set = [&](int x, float first, std::uint32_t second_id, float second) {
        const auto i = static_cast<std::size_t>(x);
        part.channels["CryptoObject00.G"].values[i] = first;
        part.channels["CryptoObject00.B"].values[i] = std::bit_cast<float>(second_id);
        part.channels["CryptoObject00.A"].values[i] = second;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    set(0, 0.25F, bush, 0.75F);  // ranks out of order
    set(1, 0.5F, bush, 0.25F);   // a quarter is empty
    set(2, 0.5F, bunny, 0.5F);   // the same surface twice
    set(3, nan, bush, -1);       // invalid coverages
    set(4, 1.5F, bush, 0.5F);    // coverages above 1
    const ForeignPicture p = read({part});
    EXPECT_EQ(p.channels.matte->name, "CryptoObject");
    ASSERT_EQ(p.mixed.size(), 3U);
    const auto share = [&](std::size_t mixed, std::size_t i) { return p.shares[p.mixed[mixed].first + i]; };
    EXPECT_EQ(p.mixed[0].pixel, 0U);
    EXPECT_EQ(share(0, 0).id, bush);
    EXPECT_EQ(share(0, 0).share, 0.75F);
    EXPECT_EQ(share(0, 1).id, bunny);
    EXPECT_EQ(p.stack(0, 0)[0].id, bush);
    ASSERT_EQ(p.mixed[1].count, 3U);
    EXPECT_EQ(share(1, 2).id, 0U);
    EXPECT_EQ(share(1, 2).share, 0.25F);
    EXPECT_EQ(p.stack(2, 0)[0].id, bunny);
    EXPECT_EQ(p.stack(3, 0)[0].id, 0U);
    EXPECT_EQ(p.mixed[2].pixel, 4U);
    EXPECT_NEAR(share(2, 0).share, 2.0 / 3, 1e-6);
    EXPECT_EQ(p.stack(3, 2)[0].id, bunny);
    // A single channel of a Cryptomatte gives the surface of its rank.
    const ForeignPicture alone = read({part}, {.ids = "CryptoObject00.R"});
    EXPECT_TRUE(alone.mixed.empty());
    EXPECT_EQ(alone.stack(0, 0)[0].id, bunny);
}

TEST_F(ForeignIds, OfCryptomattesOfSeveralPartsAndLayers) {
    // Lower-case channel names and one part per pass, as Blender writes them.
    Part part = colours();
    part.name = "ViewLayer.Combined";
    Part matte{{{"ViewLayer.CryptoObject00.r", {bits(cryptomatte_id("bush"))}},
                {"ViewLayer.CryptoObject00.g", {even(0.75F)}},
                {"ViewLayer.CryptoObject00.b", {bits(cryptomatte_id("bunny"))}},
                {"ViewLayer.CryptoObject00.a", {even(0.125F)}}},
               "ViewLayer.CryptoObject00",
               {}};
    Part second{{{"ViewLayer.CryptoObject01.r", {bits(cryptomatte_id("default"))}},
                 {"ViewLayer.CryptoObject01.g", {even(0.125F)}},
                 {"ViewLayer.CryptoObject01.b", {even(0)}},
                 {"ViewLayer.CryptoObject01.a", {even(0)}}},
                "ViewLayer.CryptoObject01",
                {}};
    Part material{with_matte("ViewLayer.CryptoMaterial").channels, "ViewLayer.CryptoMaterial00", {}};
    for (const char* name : {"R", "G", "B", "Z"}) material.channels.erase(name);
    part.texts["cryptomatte/3a1b2c3/name"] = "ViewLayer.CryptoObject";
    const std::vector<Part> parts{part, material, matte, second};
    const ForeignPicture p = read(parts);
    EXPECT_EQ(p.channels.matte->name, "ViewLayer.CryptoObject");
    EXPECT_EQ(p.channels.matte->ranks.size(), 4U);
    ASSERT_EQ(p.mixed.size(), static_cast<std::size_t>(width * height));
    ASSERT_EQ(p.mixed[7].count, 3U);
    EXPECT_EQ(p.shares[p.mixed[7].first].id, cryptomatte_id("bush"));
    EXPECT_TRUE(read(parts, {.ids = "ViewLayer.CryptoMaterial"}).mixed.empty());
}

TEST_F(ForeignIds, BrokenCryptomattesAreWarnedOfAndLeftAside) {
    const auto expect_unused = [&](const Part& part, const std::string& why) {
        const ForeignPicture p = read({part});
        EXPECT_FALSE(p.channels.matte.has_value()) << why;
        EXPECT_EQ(p.stack(0, 0)[0].id, 0U) << why;
        ASSERT_EQ(warnings(p), 1) << why;
        EXPECT_NE(p.repairs.back().text.find(why), std::string::npos) << p.repairs.back().text;
        EXPECT_LT(p.repairs.back().text.size(), 400U);
        EXPECT_EQ(p.repairs.back().text.find('\n'), std::string::npos);
    };
    Part part = with_matte();
    part.channels.erase("CryptoObject00.G");
    expect_unused(part, "no channels CryptoObject00.R and CryptoObject00.G");
    part = colours();
    part.texts = {{"cryptomatte/1234567/name", std::string(1 << 20, 'n') + "\n"}};
    expect_unused(part, "no channels nnnn");
    part.texts = {{"cryptomatte/1234567/name", "a\nb"}};
    expect_unused(part, "Cryptomatte a?b");
    part.texts = {{"cryptomatte/1234567/manifest", "{"}};
    expect_unused(part, "has no name");
    part = with_matte();
    part.channels["CryptoObject00.R"].type = Imf::HALF;
    expect_unused(part, "does not have 32 bits");
    part = with_matte();
    part.compression = Imf::DWAA_COMPRESSION;
    expect_unused(part, "compression");
    // If a channel of the second rank is missing, the first rank is used. Damaged manifests are ignored.
    part = with_matte();
    part.channels.erase("CryptoObject00.A");
    part.texts["cryptomatte/1234567/manifest"] = "{\"";
    part.texts["cryptomatte/"] = "x";
    part.texts["cryptomatte/1/2/3"] = "x";
    const ForeignPicture p = read({part});
    ASSERT_TRUE(p.channels.matte.has_value());
    EXPECT_EQ(p.channels.matte->ranks.size(), 1U);
    EXPECT_EQ(p.stack(0, 0)[0].id, cryptomatte_id("bunny"));
}

TEST_F(ForeignIds, AManifestMayStandInAFileBesideThePicture) {
    Part part = with_matte();
    part.texts.erase("cryptomatte/1234567/manifest");
    const std::string bunny = R"({"bunny":"13851a76"})";
    std::ofstream(in("names.json")) << bunny;
    part.texts["cryptomatte/1234567/manif_file"] = "names.json";
    EXPECT_EQ(read({part}).channels.matte->manifest, bunny);
    EXPECT_EQ(warnings(read({part})), 0);
    // Other folders are not read. Without names, the ids still separate surfaces.
    for (const char* file : {"none.json", "../names.json", "/etc/hostname", ".", "a\nb"}) {
        part.texts["cryptomatte/1234567/manif_file"] = file;
        const ForeignPicture p = read({part});
        ASSERT_TRUE(p.channels.matte.has_value()) << file;
        EXPECT_EQ(p.channels.matte->manifest, "") << file;
        EXPECT_EQ(p.stack(0, 0)[0].id, cryptomatte_id("bunny")) << file;
        ASSERT_EQ(warnings(p), 1) << file;
        EXPECT_EQ(p.repairs.back().text.find('\n'), std::string::npos) << file;
    }
    // A manifest in the picture itself comes first.
    part.texts["cryptomatte/1234567/manifest"] = R"({"hare":"13851a76"})";
    part.texts["cryptomatte/1234567/manif_file"] = "names.json";
    EXPECT_EQ(manifest_names(read({part}).channels.matte->manifest), std::vector<std::string>{"hare"});
}

TEST_F(ForeignIds, NamesInTheManifestOfCyclesAreNotEscaped) {
    const auto names = [&](const std::string& manifest) {
        Part part = with_matte();
        part.texts["cryptomatte/1234567/manifest"] = manifest;
        return manifest_names(read({part}).channels.matte->manifest);
    };
    EXPECT_EQ(names(R"({"12" disc":"00000001","a\"\xb":"13851a76","plain":"f763d090"})"),
              (std::vector<std::string>{"12\" disc", R"(a\"\xb)", "plain"}));
    EXPECT_EQ(names("{\"tab\t\":\"00000001\"}"), std::vector<std::string>{"tab\t"});
    EXPECT_EQ(names(R"({"":":"00000001","","":"00000002"})"), (std::vector<std::string>{"\",\"", "\":"}));
    // A valid escape is taken for what the id says that it is.
    const std::string id = fmt::format("{:08x}", cryptomatte_id(R"(a\new)"));
    EXPECT_EQ(names(R"({"a\new":")" + id + "\"}"), std::vector<std::string>{R"(a\new)"});
    EXPECT_EQ(names(R"({"a\new":"00000001"})"), std::vector<std::string>{"a\new"});
    for (const char* broken :
         {R"({"a"b":"00000001")", R"({"a"b":"00000001",})", R"({"a"b":"0000001"})", R"({"a"b":"00000001"} )",
          R"({"a"b":"00000001"x})", R"({"a"b":"00000001","c"})", R"({"a"b":"00000001",")",
          R"({"a":"00000001",")", R"({")"})
        EXPECT_EQ(names(broken), std::nullopt) << broken;
}

TEST_F(ForeignIds, WhoNamesWhatToUseIsToldOfThatAlone) {
    Part part = with_matte();
    part.texts["cryptomatte/7654321/name"] = "CryptoMaterial";
    EXPECT_EQ(warnings(read({part})), 1);
    EXPECT_EQ(warnings(read({part}, {.ids = "CryptoObject"})), 0);
    EXPECT_EQ(warnings(read({part}, {.ids = "CryptoObject00.G"})), 0);
    try {
        (void)read({part}, {.ids = "CryptoMaterial"});
        FAIL() << "taken";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("Cryptomatte CryptoMaterial is not used: no channels"),
                  std::string::npos)
            << e.what();
    }
}

TEST_F(ForeignIds, ThoseOfMotionVectorsMayLieInAnotherPart) {
    Part part = colours();
    part.name = "beauty";
    part.channels["forward.u"] = {even(2)};
    part.channels["forward.v"] = {even(0)};
    Part ids{{{"id", {even(7)}}}, "ids", {}};
    write_parts(in("a.exr"), {part, ids});
    const VectorFrame frame = read_vector_frame(in("a.exr"), {});
    EXPECT_EQ(frame.id_name, "id");
    EXPECT_EQ(frame.at(1, 1).id, std::bit_cast<std::uint32_t>(7.0F));
    EXPECT_TRUE(frame.problems.empty());
    EXPECT_EQ(read_vector_frame(in("a.exr"), {}, {.ids = "none"}).id_name, "");
    EXPECT_EQ(read_vector_frame(in("a.exr"), {}, {.ids = "id"}).at(1, 1).id, frame.at(1, 1).id);
    // One channel may be used as depth and as ids.
    const VectorFrame by_depth = read_vector_frame(in("a.exr"), {}, {.ids = "Z"});
    EXPECT_EQ(by_depth.id_name, "Z");
    EXPECT_EQ(by_depth.at(1, 1).inverse_z, 0.25F);
    EXPECT_EQ(by_depth.at(1, 1).id, std::bit_cast<std::uint32_t>(4.0F));
}

TEST_F(ForeignIds, OnlyIdsKeepTheBitsOfIntegers) {
    Part part = colours();
    part.name = "beauty";
    part.channels["R"] = {bits(2), Imf::UINT};
    part.channels["Z"] = {bits(4), Imf::UINT};
    part.channels["id"] = {bits(0xFFFFFFFEU), Imf::UINT};
    part.channels["forward.u"] = {bits(20), Imf::UINT};
    part.channels["forward.v"] = {even(0)};
    const ForeignPicture p = read({part});
    EXPECT_EQ(p.stack(1, 1)[0].r, 2);
    EXPECT_EQ(p.stack(1, 1)[0].inverse_z, 0.25F);
    EXPECT_EQ(p.stack(1, 1)[0].id, 0xFFFFFFFEU);
    const VectorFrame frame = read_vector_frame(in("a.exr"), {});
    EXPECT_EQ(frame.at(1, 1).rgb[0], 2);
    EXPECT_EQ(frame.at(1, 1).right_px, 20);
    EXPECT_EQ(frame.at(1, 1).inverse_z, 0.25F);
    EXPECT_EQ(frame.at(1, 1).id, 0xFFFFFFFEU);
    const VectorFrame by_depth = read_vector_frame(in("a.exr"), {}, {.ids = "Z"});
    EXPECT_EQ(by_depth.at(1, 1).inverse_z, 0.25F);
    EXPECT_EQ(by_depth.at(1, 1).id, 4U);
    // Depths and vectors in parts of their own.
    Part others{{{"Z", part.channels["Z"]}}, "depth", {}};
    part.channels.erase("Z");
    EXPECT_EQ(read({part, others}).stack(1, 1)[0].inverse_z, 0.25F);
    EXPECT_EQ(read_vector_frame(in("a.exr"), {}).at(1, 1).inverse_z, 0.25F);
}

// --- edges taken apart
// ---------------------------------------------------------------------------------------------

/// A row of pixels, each with one sample, whose coverages by surfaces are known.
struct Row {
    ForeignPicture p;
    explicit Row(int count) {
        p.width = p.x_end = count;
        p.height = p.y_end = 1;
    }
    void add(const StackSample& s, const std::vector<SurfaceShare>& shares = {}) {
        if (!shares.empty()) p.mixed.push_back({p.samples.size(), p.shares.size(), shares.size()});
        p.shares.insert(p.shares.end(), shares.begin(), shares.end());
        p.samples.push_back(s);
        p.offsets.push_back(p.samples.size());
    }
};

TEST(UnmixEdges, APixelOfTwoSurfacesIsAStackOfBoth) {
    const StackSample near{1, 0.8F, 0.4F, 0, 1, 1}, far{0.25F, 0, 0.2F, 0.9F, 1, 2};
    Row row(5);
    row.add(near);
    row.add(near);
    // 30 % of the pixel shows the near surface. Its depth is a mean of both surfaces.
    row.add({0.475F, 0.24F, 0.26F, 0.63F, 1, 2}, {{2, 0.7F}, {1, 0.3F}});
    row.add(far);
    row.add(far);
    const Image before = row.p.flattened();
    EXPECT_EQ(unmix_edges(row.p), 1U);
    EXPECT_TRUE(row.p.mixed.empty());
    const auto stack = row.p.stack(2, 0);
    ASSERT_EQ(stack.size(), 2U);
    EXPECT_EQ(stack[0].inverse_z, 1);
    EXPECT_EQ(stack[0].id, 1U);
    EXPECT_NEAR(stack[0].alpha, 0.3, 1e-6);
    EXPECT_NEAR(stack[0].r, 0.3 * 0.8, 1e-6);
    EXPECT_NEAR(stack[0].b, 0, 1e-6);
    EXPECT_EQ(stack[1].inverse_z, 0.25F);
    EXPECT_EQ(stack[1].alpha, 1);
    EXPECT_NEAR(stack[1].r, 0, 1e-6);
    EXPECT_NEAR(stack[1].b, 0.9, 1e-6);
    const Image after = row.p.flattened();
    EXPECT_TRUE(after.alpha.empty());
    for (std::size_t i = 0; i < before.rgb.size(); ++i) EXPECT_NEAR(after.rgb[i], before.rgb[i], 1e-6) << i;
}

TEST(UnmixEdges, AWireThatFillsNoPixelGetsWhatIsLeft) {
    const StackSample wall{0.25F, 0.1F, 0.1F, 0.1F, 1, 2};
    Row row(5);
    row.add(wall);
    row.add(wall);
    // 20 % of the pixel shows a bright wire, and the pixel has the depth of the wire.
    row.add({1, 1.08F, 0.28F, 0.08F, 1, 1}, {{2, 0.8F}, {1, 0.2F}});
    row.add(wall);
    row.add(wall);
    row.p.samples[2].id = 1;
    EXPECT_EQ(unmix_edges(row.p), 1U);
    const auto stack = row.p.stack(2, 0);
    ASSERT_EQ(stack.size(), 2U);
    EXPECT_EQ(stack[0].inverse_z, 1);
    EXPECT_NEAR(stack[0].r, 0.2 * 5, 1e-5);
    EXPECT_NEAR(stack[0].g, 0.2 * 1, 1e-5);
    EXPECT_NEAR(stack[1].r, 0.1, 1e-6);
}

TEST(UnmixEdges, EmptySpaceBesideAnObjectGetsNothingOfIt) {
    // The alpha is rounded as half floats are, and exceeds the Cryptomatte's coverage.
    const StackSample ball{1, 0.8F, 0.4F, 0, 1, 1};
    Row row(3);
    row.add({0, 0, 0, 0, 0, 0});
    row.add({1, 0.75F, 0.375F, 0, 0.93751F, 1}, {{1, 0.9375F}, {0, 0.0625F}});
    row.add(ball);
    EXPECT_EQ(unmix_edges(row.p), 1U);
    const auto stack = row.p.stack(1, 0);
    ASSERT_EQ(stack.size(), 1U);
    EXPECT_EQ(stack[0].inverse_z, 1);
    EXPECT_NEAR(stack[0].alpha, 0.9375, 2e-5);
}

TEST(UnmixEdges, TheBrightestColoursStayFinite) {
    const StackSample near{1, 0, 0, 0, 1, 1};
    Row row(3);
    row.add(near);
    row.add({0.25F, 3e38F, -3e38F, 0, 1, 2}, {{1, 0.98F}, {2, 0.02F}});
    row.add({0.25F, 3e38F, -3e38F, 0, 1, 2}, {{1, 0.98F}, {2, 0.02F}});
    EXPECT_EQ(unmix_edges(row.p), 2U);
    for (const StackSample& s : row.p.samples) EXPECT_TRUE(std::isfinite(s.r) && std::isfinite(s.g));
}

TEST(UnmixEdges, WhatNoPixelIsLikeStaysMixed) {
    // No pixel shows the second surface alone, so its depth is unknown.
    Row row(2);
    row.add({1, 0.5F, 0.5F, 0.5F, 1, 1}, {{1, 0.6F}, {2, 0.4F}});
    row.add({1, 0.5F, 0.5F, 0.5F, 1, 1});
    EXPECT_EQ(unmix_edges(row.p), 0U);
    EXPECT_EQ(row.p.samples.size(), 2U);
}

TEST(UnmixEdges, AnythingFlattensToItself) {
    // Random colours, alphas, depths and coverages: the unmixed image flattens to the original one, and only
    // differs when it is refocused.
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    constexpr int edge = 24;
    for (const bool opaque : {true, false}) {
        ForeignPicture p;
        p.width = p.x_end = p.height = p.y_end = edge;
        for (std::size_t i = 0; i < edge * edge; ++i) {
            const float alpha = opaque ? 1 : unit(random);
            StackSample s{unit(random),
                          alpha * unit(random),
                          alpha * unit(random),
                          10 * alpha * unit(random),
                          alpha,
                          static_cast<std::uint32_t>(3 * unit(random))};
            if (unit(random) < 0.5F) {
                const float share = 0.5F + 0.48F * unit(random);
                p.mixed.push_back({i, p.shares.size(), 2});
                p.shares.push_back({s.id, share});
                p.shares.push_back({(s.id + 1) % 3, 1 - share});
            }
            p.samples.push_back(s);
            p.offsets.push_back(p.samples.size());
        }
        const std::size_t mixed = p.mixed.size();
        const Image before = p.flattened();
        EXPECT_GT(unmix_edges(p), mixed / 2);
        const Image after = p.flattened();
        ASSERT_EQ(before.alpha.size(), after.alpha.size());
        for (std::size_t i = 0; i < before.alpha.size(); ++i)
            ASSERT_NEAR(after.alpha[i], before.alpha[i], 1e-5) << i;
        for (std::size_t i = 0; i < before.rgb.size(); ++i)
            ASSERT_NEAR(after.rgb[i], before.rgb[i], 1e-4) << i;
        for (int k = 0; k < edge * edge; ++k) {
            const auto stack = p.stack(k % edge, k / edge);
            for (std::size_t i = 0; i < stack.size(); ++i) {
                ASSERT_TRUE(stack[i].alpha >= 0 && stack[i].alpha <= 1);
                ASSERT_TRUE(stack[i].r >= 0 && stack[i].b >= 0);
                if (i > 0) {
                    ASSERT_GE(stack[i - 1].inverse_z, stack[i].inverse_z);
                }
            }
        }
    }
}

}  // namespace
}  // namespace postlens::test::foreign_ids_test
