// OpenEXR files of other programs: depths, cameras and deep images.
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "pictures/foreign/foreign_picture.h"
#include "pictures/image.h"
#include "tests/pictures/foreign_files.h"

namespace postlens::test::foreign_depth_test {
namespace {

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

TEST_F(ForeignPictureTest, NormalizedDepthsBeyondOneAreWarnedOf) {
    // 16 bits of an integer channel are not divided by their largest value.
    ForeignChoice choice;
    choice.depth_encoding = DepthEncoding{DepthEncoding::Kind::normalized, 1, 10};
    EXPECT_FALSE(warns(read({{rgbz(1, 1)}}, choice), "assumed"));
    EXPECT_TRUE(warns(read({{rgbz(1, 65535)}}, choice), "assumed"));
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

TEST_F(ForeignPictureTest, AShiftedWindowMovesTheAxis) {
    const ForeignCameraChoice camera{
        .film_width_mm = 36, .film_distance_mm = 36, .metres_per_unit = 0.01, .depth_along = DepthAlong::ray};
    // The window is 6 px and 2 units wide. Its centre is 1 unit right of the axis and half a unit above it.
    const ForeignPicture p = read({{rgbz(1, 300), "", "",
                                    [](Imf::Header& h) {
                                        h.screenWindowWidth() = 2;
                                        h.screenWindowCenter() = {1, 0.5F};
                                    }}},
                                  {}, camera);
    const double u = (3 - 2.5) / 6, v = (-1.5 - 1.5) / 6;
    EXPECT_NEAR(p.depth_at(0.5, 0.5), 3 / std::sqrt(1 + u * u + v * v), 1e-6);
}

TEST_F(ForeignPictureTest, DepthsHaveTheNamesThatRenderersGiveThem) {
    for (const std::string name :
         {"dd.T", "dd.y.T", "FinalImageWorldDepth.R", "FinalImageMovieRenderQueue_WorldDepth.R",
          "FinalImage_SceneDepth.R", "SceneDepthWorldUnits.R", "cameraDepth.V", "VRayZDepth.R"}) {
        Part part{rgbz(1, 2)};
        part.channels.erase("Z");
        part.channels[name] = even(4);
        const ForeignPicture p = read({part});
        EXPECT_EQ(p.channels.z, name);
        EXPECT_EQ(p.stack(0, 0)[0].inverse_z, 0.25F) << name;
    }
    // A coordinate of a texture and the depth of recursion are no depths.
    for (const std::string name : {"st.T", "rayDepth.R", "T"}) {
        Part part{rgbz(1, 2)};
        part.channels.erase("Z");
        part.channels[name] = even(4);
        part.channels["st.S"] = even(1);
        EXPECT_EQ(read({part}).channels.z, "") << name;
    }
}

TEST_F(ForeignPictureTest, PixelsNeedNotBeSquare) {
    const ForeignCameraChoice camera{
        .film_width_mm = 36, .film_distance_mm = 36, .metres_per_unit = 0.01, .depth_along = DepthAlong::ray};
    const auto of_aspect = [&](float aspect) {
        return read({{rgbz(1, 300), "", "", [=](Imf::Header& h) { h.pixelAspectRatio() = aspect; }}}, {},
                    camera);
    };
    const ForeignPicture p = of_aspect(2);
    EXPECT_FALSE(warns(p, "assumed"));
    EXPECT_EQ(p.pixel_aspect, 2);
    EXPECT_EQ(p.pixel_pitch_mm(), 3);
    // As above, but pixels are 6 mm wide and 3 mm tall.
    const double u = -15.0 / 36, v = -4.5 / 36;
    EXPECT_NEAR(p.depth_at(0.5, 0.5), 3 / std::sqrt(1 + u * u + v * v), 1e-6);
    const ForeignPicture unusable = of_aspect(1000);
    EXPECT_TRUE(warns(unusable, "assumed"));
    EXPECT_EQ(unusable.pixel_aspect, 1);
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

TEST_F(ForeignPictureTest, AParallelProjectionIsWarnedOf) {
    const auto read_with = [&](float w_of_z) {
        return read({{rgbz(1, 2), "", "", [=](Imf::Header& h) {
                          Imath::M44f ndc;
                          ndc[2][3] = w_of_z;
                          Imf::addWorldToCamera(h, Imath::M44f());
                          Imf::addWorldToNDC(h, ndc);
                      }}});
    };
    const auto says_so = [](const ForeignPicture& p) {
        return std::any_of(p.camera.assumed.begin(), p.camera.assumed.end(), [](const std::string& text) {
            return text.find("orthographic") != std::string::npos;
        });
    };
    EXPECT_TRUE(says_so(read_with(0)));
    EXPECT_FALSE(says_so(read_with(-1)));
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

TEST_F(ForeignPictureTest, VolumesMayHaveNegativeDepths) {
    const auto stack_of = [&](float sign) {
        write_deep_pixel(in("deep.exr"), {{0, 0.5F, 0, 0.5F, sign * 2, sign * 3},
                                          {0.75F, 0, 0, 0.75F, sign * 2.5F, sign * 2.5F}});
        const ForeignPicture p = read_foreign_picture(in("deep.exr"), {}, {});
        std::vector<float> out;
        for (const StackSample& s : p.samples) out.insert(out.end(), {s.inverse_z, s.r, s.g, s.alpha});
        return out;
    };
    EXPECT_GT(stack_of(1).size(), 8U);
    EXPECT_EQ(stack_of(-1), stack_of(1));
}

TEST_F(ForeignPictureTest, AVolumeMayBeginAtTheCamera) {
    for (const float sign : {1.0F, -1.0F}) {
        write_deep_pixel(in("deep.exr"), {{0, 0.75F, 0, 0.75F, 0, sign * 4},
                                          {0.5F, 0, 0, 0.5F, sign * 2, sign * 2},
                                          {1, 0, 0, 1, sign * 9, sign * 9}});
        const ForeignPicture p = read_foreign_picture(in("deep.exr"), {}, {});
        // Half of the volume, with a transmittance of 1/2, is on each side of the surface at 2.
        const Image flat = p.flattened();
        EXPECT_NEAR(flat.pixel(0, 0)[1], 0.5 + 0.5 * 0.5 * 0.5, 1e-5);
        EXPECT_NEAR(flat.pixel(0, 0)[0], 0.5 * 0.5 + 0.25 * 0.5, 1e-5);
        for (std::size_t i = 0; i + 1 < p.samples.size(); ++i)
            EXPECT_GT(p.samples[i].inverse_z, p.samples[i + 1].inverse_z);
        EXPECT_GT(p.samples.size(), 40U);
        EXPECT_TRUE(std::isfinite(p.samples[0].inverse_z));
    }
}

TEST_F(ForeignPictureTest, WithoutAnEndNoNormalizedDepthIsAVolume) {
    write_deep_pixel(in("deep.exr"), {{0.5F, 0, 0, 0.5F, 0.5F, 1}, {0, 1, 0, 1, 0.25F, 2}},
                     {"R", "G", "B", "A", "Z", "id"});
    for (const auto& [near, far] : {std::pair(20.0F, 4.0F), std::pair(4.0F, 20.0F)}) {
        const ForeignPicture p = read_foreign_picture(
            in("deep.exr"), {.depth_encoding = DepthEncoding{DepthEncoding::Kind::normalized, near, far}},
            {});
        ASSERT_EQ(p.samples.size(), 2U) << static_cast<double>(near);
        for (const float z : {12.0F, near + (far - near) / 4}) {
            EXPECT_TRUE(std::any_of(p.samples.begin(), p.samples.end(), [&](const StackSample& s) {
                return std::abs(1 / s.inverse_z - z) < 1e-5F;
            })) << static_cast<double>(z);
        }
    }
}

TEST_F(ForeignPictureTest, VolumesThatEndNowhereAreSurfaces) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const float back : {0.0F, 1.0F, 1e10F, inf, nan}) {
        write_deep_pixel(in("deep.exr"), {{0.5F, 0, 0, 0.5F, 2, back}, {0, 1, 0, 1, 3, 3}});
        const ForeignPicture p = read_foreign_picture(in("deep.exr"), {}, {});
        ASSERT_EQ(p.samples.size(), 2U) << static_cast<double>(back);
        EXPECT_EQ(p.samples[0].inverse_z, 0.5F);
        EXPECT_NEAR(p.flattened().rgb[1], 0.5, 1e-6);
    }
}

TEST_F(ForeignPictureTest, DepthsThatEndAtTheBorderContinueBeyondIt) {
    const auto shown = [](int x, int y) {
        return [x, y](Imf::Header& h) { h.displayWindow() = {{x, y}, {x + 2, y + 1}}; };
    };
    // Colours are stored from -1,-1 on, relative to the display window, and depths from 0,0 on.
    write_parts(in("a.exr"), {Part{{{"R", even(1)}, {"G", even(1)}, {"B", even(1)}}, "", "", shown(1, 1)}});
    Plane depths(static_cast<std::size_t>(width * height));
    for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = 2 + static_cast<float>(i) / 100;
    write_parts(in("z.exr"), {Part{{{"Z", depths}}, "", "", shown(0, 0)}});
    const ForeignPicture p = read_foreign_picture(in("a.exr"), {.depth_file = in("z.exr")}, {});
    ASSERT_EQ(p.x_begin, -1);
    ASSERT_EQ(p.y_begin, -1);
    for (int y = p.y_begin; y < p.y_end; ++y) {
        for (int x = p.x_begin; x < p.x_end; ++x) {
            const int i = std::max(y, 0) * width + std::max(x, 0);
            EXPECT_FLOAT_EQ(1 / p.stack(x, y)[0].inverse_z, 2 + static_cast<float>(i) / 100) << x << "," << y;
        }
    }
}

TEST_F(ForeignPictureTest, WindowsAreKept) {
    const ForeignPicture p = read_foreign_picture(data_folder + "rgbaz.exr", {}, {});
    EXPECT_EQ(p.width, 40);
    EXPECT_EQ(p.x_end - p.x_begin, 38);
    const Image image = p.flattened();
    EXPECT_EQ(image.width, 40);
    EXPECT_EQ(image.alpha[39], 0);  // outside of the data window
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
}  // namespace postlens::test::foreign_depth_test
