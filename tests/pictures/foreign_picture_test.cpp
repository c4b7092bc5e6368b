// OpenEXR files of other programs: which channels belong together.
#include "pictures/foreign/foreign_picture.h"

#include <Imath/half.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <span>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "core/job.h"
#include "pictures/foreign/foreign_file_impl.h"
#include "pictures/image.h"
#include "tests/pictures/foreign_files.h"

namespace postlens::test::foreign_picture_test {
namespace {

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

// A file is not damaged because the system refuses the thread that reads it.
TEST(Foreign, AMissingThreadIsNoDamage) {
    const auto no_thread = [] {
        throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    };
    EXPECT_THROW(foreign::guarded("a.exr", no_thread), std::system_error);
}

// Several chunks, of which the last has fewer rows, in both orders, and channels of all types.
TEST_F(ForeignPictureTest, ValuesAreTheSameWithEveryCompression) {
    constexpr int columns = 37, rows = 35;
    const Imath::Box2i display({0, 0}, {99, 99}), data({-3, 5}, {columns - 4, rows + 4});
    std::mt19937 random(3);
    const auto pixels = static_cast<std::size_t>(columns * rows);
    std::vector<Imath::half> halves(pixels);
    std::vector<float> floats(pixels);
    std::vector<std::uint32_t> wholes(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        halves[i].setBits(static_cast<std::uint16_t>(random() % 0x7c00));  // all finite positive ones
        floats[i] = static_cast<float>(random()) / 7;
        wholes[i] = static_cast<std::uint32_t>(random() % 1000);
    }
    for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                   Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
            SCOPED_TRACE(static_cast<int>(compression));
            Imf::Header h(display, data);
            h.compression() = compression;
            h.lineOrder() = order;
            Imf::FrameBuffer frame;
            const auto add = [&](const char* name, Imf::PixelType type, auto& values) {
                h.channels().insert(name, Imf::Channel(type));
                constexpr std::size_t bytes = sizeof(values[0]);
                frame.insert(name, Imf::Slice(type,
                                              reinterpret_cast<char*>(values.data() -
                                                                      (data.min.y * columns + data.min.x)),
                                              bytes, bytes * columns));
            };
            add("a", Imf::HALF, halves);
            add("b", Imf::FLOAT, floats);
            add("c", Imf::UINT, wholes);
            add("d", Imf::HALF, halves);
            {
                Imf::OutputFile out(in("a.exr").c_str(), h);
                out.setFrameBuffer(frame);
                out.writePixels(rows);
            }
            const ForeignFile file(in("a.exr"));
            int y = data.min.y;
            const std::vector<std::string> names{"c", "d", "b"};
            file.read_flat(0, names, [&](int row, std::span<const float* const> values) {
                ASSERT_EQ(row, y);
                for (std::size_t x = 0; x < columns; ++x) {
                    const std::size_t i = static_cast<std::size_t>(y - data.min.y) * columns + x;
                    EXPECT_EQ(std::bit_cast<std::uint32_t>(values[0][x]), wholes[i]);
                    EXPECT_EQ(values[1][x], static_cast<float>(halves[i]));
                    EXPECT_EQ(values[2][x], floats[i]);
                }
                ++y;
            });
            EXPECT_EQ(y, data.max.y + 1);
        }
    }
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

TEST_F(ForeignPictureTest, ANameMeansTheLayerWithoutFurtherWords) {
    // Blender calls a new view layer ViewLayer.001, and sorts its channels before those of ViewLayer.
    std::map<std::string, Plane> channels = rgbz(1, 2, "ViewLayer.001.Combined.");
    channels.merge(rgbz(3, 4, "ViewLayer.Combined."));
    channels.merge(rgbz(5, 6, "fg.light.diffuse."));
    channels.merge(rgbz(7, 8, "fg.normal."));
    for (const auto& [asked, r] : {std::tuple("ViewLayer", 3.0F), {"ViewLayer.001", 1.0F}, {"fg", 5.0F}})
        EXPECT_EQ(read({{channels}}, {.layer = asked}).stack(0, 0)[0].r, r) << asked;
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

// Of a file that has a part for every pass, the picture is used, wherever its part stands.
TEST_F(ForeignPictureTest, ThePictureIsFoundAmongThePartsOfItsPasses) {
    const Plane depth = even(4), other = even(8);
    const Part albedo{colours_of(2, ""), "albedo", ""},
        as_colours{{{"R", depth}, {"G", depth}, {"B", depth}}, "depth", ""};
    for (const char* name : {"rgba", "beauty", "ViewLayer.Combined", "shot_010.rgba"}) {
        const std::string layer = std::string(name).substr(0, std::string(name).rfind('.') + 1);
        const Part colours{colours_of(1, ""), name, ""}, depths{{{"Z", depth}}, layer + "depth", ""};
        Part with_depth = colours, other_with_depth = albedo;
        with_depth.channels["Z"] = depth;
        other_with_depth.channels["Z"] = other;
        other_with_depth.name = layer + "albedo";
        std::vector<std::vector<Part>> files{{other_with_depth, with_depth},
                                             {with_depth, other_with_depth},
                                             {with_depth, {{{"Z", other}}, layer + "shadow", ""}},
                                             {other_with_depth, colours, depths},
                                             {with_depth}};
        if (layer.empty()) {
            files.push_back({albedo, colours, depths});
            files.push_back({as_colours, colours});
        }
        for (std::size_t i = 0; i < files.size(); ++i) {
            const ForeignPicture p = read(files[i]);
            EXPECT_EQ(p.stack(0, 0)[0].r, 1) << name << " " << i;
            EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0.25F) << name << " " << i;
            EXPECT_EQ(warning(p, "assumed"), "") << name << " " << i;
        }
        EXPECT_EQ(read(files[0], {.layer = layer + "albedo"}).stack(0, 0)[0].inverse_z, 0.125F);
    }
    // A view layer without a depth, such as Blender's Composite, is not used if another one has a depth.
    const ForeignPicture p = read({{colours_of(2, ""), "Composite.Combined", ""},
                                   {{{"Z", depth}}, "ViewLayer.Depth", ""},
                                   {colours_of(1, ""), "ViewLayer.Combined", ""}});
    EXPECT_EQ(p.stack(0, 0)[0].r, 1);
    EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0.25F);
}

// RenderMan writes the colours Ci.r, Ci.g and Ci.b beside an alpha a; V-Ray and Mantra have names of their
// own for the depth.
TEST_F(ForeignPictureTest, RenderersNameAlphaAndDepthInTheirOwnWays) {
    const std::map<std::string, Plane> ci{{"Ci.r", even(0.5F)}, {"Ci.g", even(0.5F)}, {"Ci.b", even(0.5F)}};
    for (const char* depth : {"z", "Pz", "VRayZDepth", "VRayZDepth.R", "depth.r"}) {
        Part part{ci};
        part.channels["a"] = even(0.5F);
        part.channels[depth] = even(4);
        const ForeignPicture p = read({part});
        EXPECT_EQ(p.stack(0, 0)[0].alpha, 0.5F) << depth;
        EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0.25F) << depth;
    }
    // Unreal's passes have three equal channels each.
    const std::string pass = "FinalImageMovieRenderQueue_WorldDepth.";
    Part unreal{colours_of(1, "")};
    unreal.channels.merge(colours_of(4, pass));
    const ForeignPicture p = read({unreal});
    EXPECT_EQ(p.stack(0, 0)[0].r, 1);
    EXPECT_EQ(p.channels.z, pass + "R");
    // A lower-case a beside upper-case colours is something else.
    Part part{rgbz(1, 4)};
    part.channels["a"] = even(0.5F);
    EXPECT_EQ(read({part}).stack(0, 0)[0].alpha, 1);
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
    // Depths that are stored as integers are numbers.
    write_deep_pixel(in("whole.exr"), {red, later}, {"R", "G", "B", "A", "Z", "ZBack"}, "Z");
    EXPECT_EQ(read_foreign_picture(in("whole.exr"), {}, {}).flattened().rgb,
              read_deep({red, later}).flattened().rgb);
    EXPECT_EQ(read_foreign_picture(in("whole.exr"), {}, {}).samples.front().inverse_z,
              read_deep({red, later}).samples.front().inverse_z);
    // A surface inside a volume stays opaque.
    const std::array<float, 6> wall{0, 1, 0, 1, 3, 3};
    EXPECT_NEAR(read_deep({red, wall}).flattened().alpha.empty() ? 1 : 0, 1, 0);
}

// The slices of a deep volume have equal ratios of far to near depth, and optical depths that are
// proportional to their lengths.
TEST_F(ForeignPictureTest, SlicesOfAVolumeHaveEqualRatiosOfDepth) {
    for (const float front : {1.0F, 0.0F}) {
        const float back = 64;
        const ForeignPicture p = read_deep({{0.5F, 0.25F, 0, 0.75F, front, back}});
        ASSERT_EQ(p.samples.size(), 32U);
        double near = static_cast<double>(front), optical_depth = 0;
        for (std::size_t i = 0; i < 32; ++i) {
            const StackSample& s = p.samples[i];
            const double far = 2 / static_cast<double>(s.inverse_z) - near, whole = -std::log(0.25);
            const double part = -std::log1p(-static_cast<double>(s.alpha));
            EXPECT_NEAR(part, whole * (far - near) / static_cast<double>(back - front), 1e-6) << i;
            if (near > 0) {
                const double ratio = front > 0 ? std::pow(64, 1 / 32.0) : std::pow(100, 1 / 31.0);
                EXPECT_NEAR(far / near, ratio, 1e-4) << i;
            } else {
                EXPECT_LE(part, 0.01 * whole + 1e-6);
            }
            near = far;
            optical_depth += part;
        }
        EXPECT_NEAR(near, 64, 1e-3);
        EXPECT_NEAR(optical_depth, -std::log(0.25), 1e-5);
        EXPECT_NEAR(p.flattened().rgb[0], 0.5, 1e-5);
    }
}

// Fog from Z to ZBack with a transmittance of t lets a surface after the share a of its way through t^a.
TEST_F(ForeignPictureTest, ASurfaceInsideAVolumeStandsAtItsOwnDepth) {
    const double t = 0.1;
    for (const float back : {2.03F, 2.4F, 6.0F}) {
        for (const double a : {0.0, 0.15, 0.5, 0.999}) {
            const std::array<float, 6> fog{0, 0, 0.9F, 0.9F, 2, back};
            const auto z = static_cast<float>(2 + a * (static_cast<double>(back) - 2));
            for (const float alpha : {0.5F, 1.0F}) {
                const std::array<float, 6> sheet{alpha, 0, 0, alpha, z, z};
                const Image image = read_deep({fog, sheet}).flattened();
                const double before = std::pow(t, a), behind = (1 - static_cast<double>(alpha)) * before;
                EXPECT_NEAR(image.rgb[0], static_cast<double>(alpha) * before, 1e-5) << back << " " << a;
                EXPECT_NEAR(image.rgb[2], 1 - before + behind - behind * t / before, 1e-5)
                    << back << " " << a;
            }
        }
    }
}

TEST_F(ForeignPictureTest, GreyAndNothingButAlpha) {
    EXPECT_EQ(read({{{{"Y", even(0.5F)}, {"Z", even(2)}}}}).stack(1, 1)[0].g, 0.5F);
    const ForeignPicture p = read({{{{"A", even(0.5F)}, {"Z", even(2)}}}});
    EXPECT_EQ(p.stack(1, 1)[0].g, 0);
    EXPECT_EQ(p.stack(1, 1)[0].alpha, 0.5F);
    EXPECT_NE(refusal([&] { (void)read({{{{"U", even(1)}}}}); }).find("got channels U"), std::string::npos);
}

TEST_F(ForeignPictureTest, ReadingEndsWhenItsJobIsCancelled) {
    const auto rows_before_the_end = [&](const std::string& path) {
        const ForeignFile file(path);
        const std::vector<std::string> channels{"R"};
        Job job({.threads = 2});
        const JobScope scope(job);
        job.cancel();
        int rows = 0;
        try {
            if (file.parts()[0].deep) {
                file.read_deep(0, channels, [&](const DeepRows&) { ++rows; });
            } else {
                file.read_flat(0, channels, [&](int, std::span<const float* const>) { ++rows; });
            }
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::interrupted) << e.what();
        }
        return rows;
    };
    write_parts(in("flat.exr"), {{rgbz(1, 2)}});
    write_deep_pixel(in("deep.exr"), {{1, 0.5F, 0.25F, 1, 2, 2}});
    EXPECT_EQ(rows_before_the_end(in("flat.exr")), 0);
    EXPECT_EQ(rows_before_the_end(in("deep.exr")), 0);
}

}  // namespace
}  // namespace postlens::test::foreign_picture_test
