// Reading OpenEXR files of other programs: channels, cameras, repairs and errors.
#include "pictures/foreign/foreign_picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <map>

#include "core/error.h"
#include "pictures/exr/exr_attributes.h"
#include "pictures/image.h"
#include "tests/support/temporary_folder.h"

namespace postlens {
namespace {

constexpr int width = 6, height = 4;
const std::string data_folder = std::string(POSTLENS_TEST_DATA) + "/exr/";

using Plane = std::vector<float>;
/// A part and its channels. A channel has a single value, or one value per pixel.
struct Part {
    std::map<std::string, Plane> channels;
    std::string name, view;
    std::function<void(Imf::Header&)> more = [](Imf::Header&) {};
};

Plane even(float v) {
    return Plane(static_cast<std::size_t>(width * height), v);
}

void write_parts(const std::string& path, const std::vector<Part>& parts) {
    std::vector<Imf::Header> headers;
    for (const Part& p : parts) {
        Imf::Header h(width, height);
        h.setType(Imf::SCANLINEIMAGE);
        if (!p.name.empty()) h.setName(p.name);
        if (!p.view.empty()) h.setView(p.view);
        for (const auto& [name, plane] : p.channels) h.channels().insert(name, Imf::Channel(Imf::FLOAT));
        p.more(h);
        headers.push_back(h);
    }
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::FrameBuffer frame;
        for (const auto& [name, plane] : parts[i].channels) {
            frame.insert(name,
                         Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(plane.data())),
                                    sizeof(float), sizeof(float) * width));
        }
        Imf::OutputPart out(file, static_cast<int>(i));
        out.setFrameBuffer(frame);
        out.writePixels(height);
    }
}

using DeepNames = std::array<const char*, 6>;

/// Writes a deep image of one pixel.
void write_deep_pixel(const std::string& path, const std::vector<std::array<float, 6>>& samples,
                      const DeepNames& names = {"R", "G", "B", "A", "Z", "ZBack"}) {
    Imf::Header h(1, 1);
    h.setType(Imf::DEEPSCANLINE);
    h.compression() = Imf::ZIPS_COMPRESSION;
    for (const char* n : names) h.channels().insert(n, Imf::Channel(Imf::FLOAT));
    Imf::DeepScanLineOutputFile out(path.c_str(), h);
    unsigned count = static_cast<unsigned>(samples.size());
    std::array<Plane, 6> values;
    std::array<float*, 6> pointers{};
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(&count), sizeof(unsigned), sizeof(unsigned)));
    for (std::size_t c = 0; c < 6; ++c) {
        for (const auto& s : samples) values[c].push_back(s[c]);
        pointers[c] = values[c].data();
        frame.insert(names[c], Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(&pointers[c]),
                                              sizeof(float*), sizeof(float*), sizeof(float)));
    }
    out.setFrameBuffer(frame);
    out.writePixels(1);
}

class ForeignPictureTest : public testing::Test {
  protected:
    ForeignPicture read_deep(const std::vector<std::array<float, 6>>& samples) {
        write_deep_pixel(in("deep.exr"), samples);
        return read_foreign_picture(in("deep.exr"), {}, {});
    }
    std::string in(const std::string& name) { return (folder_.path() / name).string(); }
    ForeignPicture read(const std::vector<Part>& parts, const ForeignChoice& choice = {},
                        const ForeignCameraChoice& camera = {}) {
        write_parts(in("a.exr"), parts);
        return read_foreign_picture(in("a.exr"), choice, camera);
    }
    static std::string refusal(const std::function<void()>& call) {
        try {
            call();
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.what();
        }
        ADD_FAILURE() << "nothing was refused";
        return "";
    }
    test::TemporaryFolder folder_;
};

std::map<std::string, Plane> rgbz(float r, float z, const std::string& layer = "") {
    return {{layer + "R", even(r)},
            {layer + "G", even(0.5F)},
            {layer + "B", even(0.25F)},
            {layer + "Z", even(z)}};
}

bool warns(const ForeignPicture& p, const std::string& code) {
    return std::any_of(p.repairs.begin(), p.repairs.end(),
                       [&](const ForeignRepair& r) { return r.code == code; });
}

// --- channels
// ---------------------------------------------------------------------------------------------------

TEST_F(ForeignPictureTest, PlainColourAndDepth) {
    const ForeignPicture p = read({{rgbz(0.75F, 4)}});
    EXPECT_EQ(p.width, width);
    EXPECT_FALSE(p.deep);
    ASSERT_EQ(p.stack(2, 1).size(), 1U);
    const StackSample& s = p.stack(2, 1)[0];
    EXPECT_EQ(s.r, 0.75F);
    EXPECT_EQ(s.alpha, 1);
    EXPECT_EQ(s.inverse_z, 0.25F);
    EXPECT_EQ(p.depth_at(2.5, 1.5), 4);
}

TEST_F(ForeignPictureTest, BlendersLayersBelongTogether) {
    std::map<std::string, Plane> channels;
    for (const auto& [layer, r, z] : {std::tuple("Room", 0.1F, 2.0F), {"Ball", 0.9F, 5.0F}}) {
        const std::string l = layer;
        channels[l + ".Combined.R"] = even(r);
        for (const char* c : {"G", "B", "A"}) channels[l + ".Combined." + c] = even(1);
        channels[l + ".Depth.Z"] = even(z);
    }
    const ForeignPicture first = read({{channels}});
    EXPECT_EQ(first.channels.r, "Ball.Combined.R");  // the first layer; the channels of a file are sorted
    EXPECT_EQ(first.channels.z, "Ball.Depth.Z");
    // The compositor's layer comes first in the file, but is not chosen, because it has no depth.
    Part composed{channels};
    for (const char* c : {"R", "G", "B"})
        composed.channels[std::string("A composite.Combined.") + c] = even(1);
    EXPECT_EQ(read({composed}).channels.r, "Ball.Combined.R");
    EXPECT_EQ(read({composed}, {.layer = "A composite"}).channels.z, "");
    const ForeignPicture room = read({{channels}}, {.layer = "Room"});
    EXPECT_EQ(room.stack(0, 0)[0].r, 0.1F);
    EXPECT_EQ(room.stack(0, 0)[0].inverse_z, 0.5F);
    EXPECT_EQ(room.channels.a, "Room.Combined.A");
}

TEST_F(ForeignPictureTest, ViewsAndPartsAreChosenByName) {
    // A stereo file of several parts, with the depth of each view in a separate part.
    const std::vector<Part> parts{
        {{{"R", even(1)}, {"G", even(1)}, {"B", even(1)}}, "rgba.right", "right"},
        {{{"R", even(2)}, {"G", even(2)}, {"B", even(2)}}, "rgba.left", "left"},
        {{{"Z", even(8)}}, "depth.right", "right"},
        {{{"Z", even(16)}}, "depth.left", "left"},
    };
    EXPECT_EQ(read(parts).stack(0, 0)[0].r, 1);
    EXPECT_EQ(read(parts).stack(0, 0)[0].inverse_z, 1.0F / 8);
    for (const char* name : {"left", "rgba.left"}) {
        EXPECT_EQ(read(parts, {.layer = name}).stack(0, 0)[0].r, 2) << name;
        EXPECT_EQ(read(parts, {.layer = name}).stack(0, 0)[0].inverse_z, 1.0F / 16) << name;
    }
    // The same in a single part: channel names of the first view do not contain its name.
    Part single{rgbz(3, 2), "", "", [](Imf::Header& h) { Imf::addMultiView(h, {"right", "left"}); }};
    single.channels.merge(rgbz(4, 5, "left."));
    EXPECT_EQ(read({single}).stack(0, 0)[0].r, 3);
    EXPECT_EQ(read({single}, {.layer = "right"}).stack(0, 0)[0].r, 3);
    EXPECT_EQ(read({single}, {.layer = "left"}).stack(0, 0)[0].r, 4);
    EXPECT_EQ(read({single}, {.layer = "left"}).stack(0, 0)[0].inverse_z, 0.2F);
    EXPECT_NE(refusal([&] { (void)read({single}, {.layer = "middle"}); }).find("no colours in middle"),
              std::string::npos);
}

std::map<std::string, Plane> colours_of(float r, const std::string& layer) {
    return {{layer + "R", even(r)}, {layer + "G", even(0.5F)}, {layer + "B", even(0.25F)}};
}

/// The text of the warning with this code; empty if there is none.
std::string warning(const ForeignPicture& p, const std::string& code) {
    for (const ForeignRepair& r : p.repairs) {
        if (r.code == code && r.text.find("not in the file") == std::string::npos) return r.text;
    }
    return "";
}

// Each view and each layer gets the depth of its own name, in any order of the words in channel names.
TEST_F(ForeignPictureTest, DepthsOfViewsAndLayersAreToldApart) {
    struct Case {
        const char *left, *right, *left_z, *right_z;
        bool declared;
    };
    for (const Case& c :
         {Case{"", "right.", "depth.Z", "right.depth.Z", true},
          {"", "right.", "left.depth.Z", "depth.right.Z", true},
          {"left.", "right.", "depth.left.Z", "right.depth.Z", false},
          {"left.", "right.", "left.Z", "right.Z", false},
          {"main.rgba.", "other.rgba.", "depth.main.Z", "other.depth.Z", false},
          {"View.Combined.left.", "View.Combined.right.", "View.Depth.left.Z", "View.Depth.right.V", true}}) {
        Part part{colours_of(1, c.left), "", "", [&](Imf::Header& h) {
                      if (c.declared) Imf::addMultiView(h, {"left", "right"});
                  }};
        part.channels.merge(colours_of(2, c.right));
        part.channels[c.left_z] = even(4);
        part.channels[c.right_z] = even(8);
        const bool views = std::string(c.right).find("right") != std::string::npos;
        for (const bool left : {true, false}) {
            const ForeignPicture p =
                read({part}, {.layer = views ? (left ? "left" : "right") : (left ? "main" : "other")});
            EXPECT_EQ(p.stack(0, 0)[0].r, left ? 1 : 2) << c.left_z;
            EXPECT_EQ(p.channels.z, left ? c.left_z : c.right_z);
            EXPECT_EQ(warning(p, "assumed"), "") << c.left_z;
        }
        // The depth of another view or layer is not used, but mentioned in a warning.
        part.channels.erase(c.right_z);
        const ForeignPicture p = read({part}, {.layer = views ? "right" : "other"});
        EXPECT_EQ(p.channels.z, "");
        EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0);
        EXPECT_NE(warning(p, "assumed").find(std::string(c.left_z) + " is not taken as the depth"),
                  std::string::npos)
            << warning(p, "assumed");
    }
}

TEST_F(ForeignPictureTest, PartsMayHoldBareNames) {
    const auto part = [](const std::string& name, std::map<std::string, Plane> channels) {
        return Part{std::move(channels), name, ""};
    };
    // Colour, alpha, depth and ids of two layers in separate parts, whose channels are named by single
    // letters.
    const std::vector<Part> parts{part("near.depth", {{"V", even(2)}}),   part("far_rgb", colours_of(1, "")),
                                  part("near_rgb", colours_of(2, "")),    part("far_depth", {{"Z", even(8)}}),
                                  part("far_alpha", {{"A", even(0.5F)}}), part("near_id", {{"id", even(3)}})};
    const ForeignPicture far = read(parts, {.layer = "far"}), near = read(parts, {.layer = "near"});
    EXPECT_EQ(far.stack(0, 0)[0].r, 1);
    EXPECT_EQ(far.stack(0, 0)[0].inverse_z, 1.0F / 8);
    EXPECT_EQ(far.stack(0, 0)[0].alpha, 0.5F);
    EXPECT_EQ(far.channels.id, "");
    EXPECT_NE(warning(far, "ids").find("ids id belong to near, not to far"), std::string::npos)
        << warning(far, "ids");
    EXPECT_EQ(near.stack(0, 0)[0].r, 2);
    EXPECT_EQ(near.stack(0, 0)[0].inverse_z, 0.5F);
    EXPECT_EQ(near.stack(0, 0)[0].alpha, 1);
    EXPECT_EQ(near.channels.id, "id");
}

TEST_F(ForeignPictureTest, WhatIsSurmisedIsSaid) {
    // A pass without depth gets the depth of the whole image, with a warning.
    Part passes{rgbz(1, 4)};
    passes.channels.merge(colours_of(2, "diffuse."));
    const ForeignPicture pass = read({passes}, {.layer = "diffuse"});
    EXPECT_EQ(pass.channels.z, "Z");
    EXPECT_NE(warning(pass, "assumed").find("diffuse has none of its own"), std::string::npos);
    EXPECT_EQ(warning(read({passes}), "assumed"), "");
    // The only depth in the file is used, although its part has an unrelated name.
    const ForeignPicture only = read({{colours_of(1, ""), "render", ""}, {{{"Z", even(4)}}, "extra", ""}});
    EXPECT_EQ(only.channels.z, "Z");
    EXPECT_NE(warning(only, "assumed").find("Z of extra is taken"), std::string::npos);
    // The Z of positions and directions is no depth.
    Part place{colours_of(1, "")};
    for (const char* name : {"P.X", "P.Y", "P.Z", "normal.Z"}) place.channels[name] = even(4);
    EXPECT_EQ(read({place}).channels.z, "");
    // The Cryptomatte of another layer is not used.
    Part mattes{rgbz(1, 4, "a.")};
    mattes.channels.merge(rgbz(2, 4, "b."));
    for (const char* letter : {"R", "G", "B", "A"})
        mattes.channels[std::string("a.CryptoObject00.") + letter] = even(1);
    EXPECT_TRUE(read({mattes}, {.layer = "a"}).channels.matte.has_value());
    const ForeignPicture b = read({mattes}, {.layer = "b"});
    EXPECT_FALSE(b.channels.matte.has_value());
    EXPECT_NE(warning(b, "ids").find("Cryptomatte a.CryptoObject belongs to a, not to b"), std::string::npos)
        << warning(b, "ids");
}

TEST_F(ForeignPictureTest, ADepthOfAnyNameCanBeAskedFor) {
    Part part{rgbz(1, 2)};
    part.channels["camera.distance"] = even(4);
    EXPECT_EQ(read({part}, {.depth_channel = "camera.distance"}).stack(0, 0)[0].inverse_z, 0.25F);
    EXPECT_NE(refusal([&] { (void)read({part}, {.depth_channel = "W"}); }).find("no channel W"),
              std::string::npos);
    part.channels.erase("Z");
    EXPECT_TRUE(warns(read({part}), "assumed"));
}

TEST_F(ForeignPictureTest, VolumesEndWhereTheirOwnLayerSays) {
    const std::vector<std::array<float, 6>> fog{{0.3F, 0, 0, 0.5F, 2, 4}};
    for (const bool own : {true, false}) {
        write_deep_pixel(in("deep.exr"), fog,
                         {"fog.R", "fog.G", "fog.B", "fog.A", "fog.Z", own ? "fog.ZBack" : "ZBack"});
        const ForeignPicture p = read_foreign_picture(in("deep.exr"), {}, {});
        EXPECT_EQ(p.channels.z_back, own ? "fog.ZBack" : "");
        EXPECT_EQ(p.samples.size() > 1, own);
    }
}

// Two volumes in the same depth range combine as A = 1 - (1 - A1)(1 - A2) and
// C = A (u1 C1 / A1 + u2 C2 / A2) / (u1 + u2) with u = -log(1 - A).
TEST_F(ForeignPictureTest, VolumesInOnePlaceAreMixedInAnyOrder) {
    const std::array<float, 6> red{0.3F, 0, 0, 0.5F, 2, 4}, blue{0, 0, 0.6F, 0.75F, 2, 4};
    const double u1 = std::log(2), u2 = std::log(4), alpha = 0.875;
    const auto flat = [&](const std::vector<std::array<float, 6>>& samples) {
        const Image image = read_deep(samples).flattened();
        return std::array{image.rgb[0], image.rgb[2], image.alpha[0]};
    };
    const auto one = flat({red, blue}), other = flat({blue, red});
    EXPECT_EQ(one, other);
    EXPECT_NEAR(one[0], alpha * (u1 * 0.6) / (u1 + u2), 1e-6);
    EXPECT_NEAR(one[1], alpha * (u2 * 0.8) / (u1 + u2), 1e-6);
    EXPECT_NEAR(one[2], alpha, 1e-6);
    // One volume begins inside the other, or the volumes only touch.
    std::array<float, 6> later = blue;
    later[4] = 3;
    later[5] = 6;
    EXPECT_EQ(flat({red, later}), flat({later, red}));
    EXPECT_NEAR(flat({red, later})[2], alpha, 1e-6);
    later[4] = 4;
    const auto apart = flat({later, red});
    EXPECT_NEAR(apart[0], 0.3, 1e-6);
    EXPECT_NEAR(apart[1], 0.5 * 0.6, 1e-6);
    // A surface inside a volume stays opaque.
    const std::array<float, 6> wall{0, 1, 0, 1, 3, 3};
    EXPECT_NEAR(read_deep({red, wall}).flattened().alpha.empty() ? 1 : 0, 1, 0);
}

TEST_F(ForeignPictureTest, GreyAndNothingButAlpha) {
    EXPECT_EQ(read({{{{"Y", even(0.5F)}, {"Z", even(2)}}}}).stack(1, 1)[0].g, 0.5F);
    const ForeignPicture p = read({{{{"A", even(0.5F)}, {"Z", even(2)}}}});
    EXPECT_EQ(p.stack(1, 1)[0].g, 0);
    EXPECT_EQ(p.stack(1, 1)[0].alpha, 0.5F);
    EXPECT_NE(refusal([&] { (void)read({{{{"U", even(1)}}}}); }).find("got channels U"), std::string::npos);
}

// --- depth and camera
// -------------------------------------------------------------------------------------------

TEST_F(ForeignPictureTest, NothingHitIsInfinitelyFar) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const float z : {0.0F, 1e9F, 1e10F, inf, -inf, nan}) {
        Part part{rgbz(1, 2)};
        part.channels["Z"][0] = z;
        const ForeignPicture p = read({part});
        EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0) << static_cast<double>(z);
        EXPECT_EQ(p.stack(1, 0)[0].inverse_z, 0.5F);
        EXPECT_TRUE(std::isinf(p.depth_at(0.5, 0.5)));
    }
}

TEST_F(ForeignPictureTest, DepthsOfOneSignAreDistancesOfBothRefused) {
    Part part{rgbz(1, -4)};
    const ForeignPicture p = read({part});
    EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0.25F);
    EXPECT_TRUE(warns(p, "assumed"));
    part.channels["Z"][0] = 2;
    EXPECT_NE(refusal([&] { (void)read({part}); }).find("channel Z at pixel 1,0"), std::string::npos);
}

TEST_F(ForeignPictureTest, DepthsAlongTheRayBecomeDepthsAlongTheAxis) {
    const ForeignCameraChoice camera{
        .film_width_mm = 36, .film_distance_mm = 36, .metres_per_unit = 0.01, .depth_along = DepthAlong::ray};
    const ForeignPicture p = read({{rgbz(1, 300)}}, {}, camera);
    EXPECT_TRUE(p.camera.assumed.empty());
    // On a film at 36 mm from the pinhole, the pixel's centre is 2.5 px of 6 mm left of the axis and 1.5 px
    // above it.
    const double u = -15.0 / 36, v = -9.0 / 36;
    EXPECT_NEAR(p.depth_at(0.5, 0.5), 3 / std::sqrt(1 + u * u + v * v), 1e-6);
}

TEST_F(ForeignPictureTest, StandardAttributesNameTheCamera) {
    const ForeignPicture p = read({{rgbz(1, 2), "", "", [](Imf::Header& h) {
                                        h.insert("nominalFocalLength", Imf::FloatAttribute(35));
                                        h.insert("pinholeFocalLength", Imf::FloatAttribute(36.5F));
                                        h.insert("sensorOverallDimensions", Imf::V2fAttribute({24.5F, 14}));
                                        h.insert("aperture", Imf::FloatAttribute(2.5F));
                                        h.insert("focus", Imf::FloatAttribute(3));
                                    }}});
    EXPECT_EQ(p.camera.focal_length_mm, 35);
    EXPECT_EQ(p.camera.film_distance_mm, 36.5);
    EXPECT_EQ(p.camera.film_width_mm, 24.5);
    EXPECT_EQ(p.camera.f_number, 2.5);
    EXPECT_EQ(p.camera.focus_m, 3);
    EXPECT_EQ(p.camera.assumed.size(), 2U);  // unit and direction of depth
    // Settings of the user take precedence. Invalid attributes are ignored.
    const ForeignPicture asked = read({{rgbz(1, 2), "", "",
                                        [](Imf::Header& h) {
                                            h.insert("pinholeFocalLength", Imf::FloatAttribute(-1));
                                            h.insert("sensorOverallDimensions", Imf::V2fAttribute({0, 0}));
                                        }}},
                                      {}, {.focal_length_mm = 80});
    EXPECT_EQ(asked.camera.focal_length_mm, 80);
    EXPECT_EQ(asked.camera.film_distance_mm, 80);
    EXPECT_EQ(asked.camera.film_width_mm, 36);
    EXPECT_EQ(asked.camera.assumed.size(), 3U);
}

TEST_F(ForeignPictureTest, MatricesNameTheView) {
    // Matrices for row vectors. The camera looks along -z of its own space, is 4 units up the axis and is
    // rotated.
    const double c = std::cos(0.4), s = std::sin(0.4);
    const Matrix44 camera{c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0, 1.5, -2, 4, 1};
    const auto product = [](const Matrix44& a, const Matrix44& b) {
        Matrix44 out{};
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                for (std::size_t k = 0; k < 4; ++k) out[4 * i + j] += a[4 * i + k] * b[4 * k + j];
            }
        }
        return out;
    };
    const double tangent = 0.3;
    // Projections to [-1, 1], and to [0, 1] with y downwards; w is the distance -z.
    const Matrix44 centred{1 / tangent, 0, 0, 0, 0, 1 / tangent, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0};
    const Matrix44 from_zero{0.5 / tangent, 0, 0, 0, 0, -0.5 / tangent, 0, 0, -0.5, -0.5, 1, -1, 0, 0, 0, 0};
    for (const Matrix44& projection : {centred, from_zero}) {
        const auto found = half_width_tangent(camera, product(camera, projection));
        ASSERT_TRUE(found.has_value());
        EXPECT_NEAR(*found, tangent, 1e-12);
    }
    const Matrix44 orthographic{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_FALSE(half_width_tangent(camera, product(camera, orthographic)).has_value());
    EXPECT_FALSE(half_width_tangent(Matrix44{}, centred).has_value());
    // A file of a renderer whose matrices describe a field of view of 45 degrees.
    const ForeignPicture p = read_foreign_picture(data_folder + "deep_alpha.exr", {}, {});
    EXPECT_NEAR(p.camera.film_distance_mm, 18 / std::tan(std::acos(-1.0) / 8), 1e-3);
    EXPECT_EQ(p.camera.assumed.size(), 3U);  // film width, and unit and direction of depth
}

// --- deep pictures
// ----------------------------------------------------------------------------------------------

void expect_equal(const std::string& deep, const std::string& flat, double tolerance) {
    const ForeignPicture p = read_foreign_picture(deep, {}, {}),
                         reference = read_foreign_picture(flat, {}, {});
    EXPECT_TRUE(p.deep);
    const Image mine = p.flattened(), theirs = reference.flattened();
    ASSERT_EQ(mine.rgb.size(), theirs.rgb.size());
    ASSERT_EQ(mine.alpha.size(), theirs.alpha.size());
    double brightest = 0;
    for (std::size_t i = 0; i < mine.rgb.size(); ++i) ASSERT_NEAR(mine.rgb[i], theirs.rgb[i], tolerance) << i;
    for (std::size_t i = 0; i < mine.alpha.size(); ++i) {
        ASSERT_NEAR(mine.alpha[i], theirs.alpha[i], tolerance) << i;
        brightest = std::max(brightest, static_cast<double>(mine.alpha[i]));
    }
    EXPECT_GT(brightest, 0.4);  // the images are not empty
}

TEST_F(ForeignPictureTest, FlattensAsAnotherProgramDoes) {
    // The images are stored as halves. The two programs multiply in different orders, which changes
    // roundings.
    expect_equal(data_folder + "deep_object_ids.exr", data_folder + "deep_object_ids.flattened.exr", 1e-6);
    expect_equal(data_folder + "deep_alpha.exr", data_folder + "deep_alpha.flattened.exr", 1e-6);
}

TEST_F(ForeignPictureTest, SamplesAreSortedAndVolumesSliced) {
    write_deep_pixel(in("deep.exr"),
                     {{0.2F, 0, 0, 1, 9, 9}, {0, 0.75F, 0, 0.75F, 2, 4}, {0.5F, 0, 0, 0.5F, 1, 1}});
    const ForeignPicture p = read_foreign_picture(in("deep.exr"), {}, {.metres_per_unit = 2});
    const auto stack = p.stack(0, 0);
    // log 2 / log 1.02 = 35.003 slices would be needed, which exceeds the limit.
    ASSERT_EQ(stack.size(), 34U);
    EXPECT_EQ(stack[0].inverse_z, 0.5F);
    double left = 1, light = 0;
    for (const StackSample& s : stack.subspan(1, 32)) {
        EXPECT_LT(s.inverse_z, 0.25F);
        EXPECT_GT(s.inverse_z, 0.125F);
        light += left * static_cast<double>(s.g);
        left *= 1 - static_cast<double>(s.alpha);
    }
    EXPECT_NEAR(1 - left, 0.75, 1e-5);
    EXPECT_NEAR(light, 0.75, 1e-5);
    const Image flat = p.flattened();
    EXPECT_TRUE(flat.alpha.empty());
    EXPECT_NEAR(flat.pixel(0, 0)[0], 0.5 + 0.5 * 0.25 * 0.2, 1e-5);
    EXPECT_NEAR(flat.pixel(0, 0)[1], 0.5 * 0.75, 1e-5);
}

TEST_F(ForeignPictureTest, WindowsAreKept) {
    const ForeignPicture p = read_foreign_picture(data_folder + "rgbaz.exr", {}, {});
    EXPECT_EQ(p.width, 40);
    EXPECT_EQ(p.x_end - p.x_begin, 38);
    const Image image = p.flattened();
    EXPECT_EQ(image.width, 40);
    EXPECT_EQ(image.alpha[39], 0);  // outside of the data window
}

// --- repairs and refusals
// ---------------------------------------------------------------------------------------

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

TEST_F(ForeignPictureTest, AlphasBeyondOneAreCutOff) {
    Part part{rgbz(1, 2)};
    part.channels["A"] = even(1);
    part.channels["A"][3] = 1.5F;
    part.channels["A"][4] = std::numeric_limits<float>::quiet_NaN();
    const ForeignPicture p = read({part});
    EXPECT_TRUE(warns(p, "repaired"));
    for (const StackSample& s : p.samples) EXPECT_EQ(s.alpha, 1);
}

TEST_F(ForeignPictureTest, RefusesWhatIsNoWholeFile) {
    write_parts(in("whole.exr"), {{rgbz(1, 2)}});
    std::ifstream file(in("whole.exr"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
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
    std::ifstream file(in("whole.exr"), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
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
    std::ifstream file(data_folder + "nan_inf.exr", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const auto wide = [&](auto&& change) {
        std::string wider = bytes;
        const std::string_view window("dataWindow\0box2i\0\x10\0\0", 21);
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
        std::ifstream file(data_folder + name, std::ios::binary);
        std::string bytes{std::istreambuf_iterator<char>(file), {}};
        bytes.replace(chunk + packed, 8, std::string("\0\0\0\x40\0\0\0\0", 8));  // 1 GiB
        std::ofstream(in(name), std::ios::binary) << bytes;
        const std::string said = refusal([&] { (void)read_foreign_picture(in(name), {}, {}); });
        EXPECT_NE(said.find("a chunk is damaged (got 10737"), std::string::npos) << said;
    }
}

// The OpenEXR library reads four bytes beyond the end of a manifest.
TEST(ExrAttribute, NothingShortFollowsAManifest) {
    const test::TemporaryFolder folder;
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
    const test::TemporaryFolder folder;
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

TEST_F(ForeignPictureTest, CameraOptionsOutOfRangeAreRefused) {
    write_parts(in("a.exr"), {{rgbz(1, 2)}});
    for (const ForeignCameraChoice& choice :
         {ForeignCameraChoice{.film_width_mm = 0}, ForeignCameraChoice{.film_distance_mm = -1},
          ForeignCameraChoice{.metres_per_unit = std::numeric_limits<double>::infinity()}}) {
        try {
            (void)read_foreign_picture(in("a.exr"), {}, choice);
            ADD_FAILURE();
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::wrong_arguments);
        }
    }
}

}  // namespace
}  // namespace postlens
