// glTF: triangles, materials and images.
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "pictures/image.h"
#include "scene/file_digest.h"
#include "scene/metallic_roughness.h"
#include "scene/scene.h"
#include "tests/scene/gltf_text.h"
#include "tests/scene/mesh_text.h"
#include "tests/support/file_bytes.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/shading.h"

namespace postlens::test::gltf_surface_test {
namespace {

namespace fs = std::filesystem;
using glm::dvec3;
using testing::HasSubstr;

TEST(MetallicRoughness, HasItsLimitsInWhittedsModel) {
    const dvec3 red(0.8, 0.2, 0.1);
    const Material matt = whitted_material({.base = red, .metallic = 0, .roughness = 1});
    EXPECT_EQ(matt.diffuse, red);
    EXPECT_EQ(matt.reflection, dvec3(0));
    EXPECT_EQ(matt.specular, dvec3(0));
    EXPECT_EQ(matt.transmission, dvec3(0));
    const Material mirror = whitted_material({.base = red, .metallic = 1, .roughness = 0});
    EXPECT_EQ(mirror.diffuse, dvec3(0));
    EXPECT_EQ(mirror.reflection, red);
    EXPECT_TRUE(std::isinf(mirror.reflection_exponent));
    const Material rough_metal = whitted_material({.base = red, .metallic = 1, .roughness = 1});
    EXPECT_EQ(rough_metal.diffuse, red);
    EXPECT_EQ(rough_metal.reflection, dvec3(0));
    // F0 is 0.04 for an index of 1.5. A solid body refracts, a thin sheet does not.
    const Material glass =
        whitted_material({.metallic = 0, .roughness = 0, .transmission = 1, .ior = 1.5, .solid = true});
    EXPECT_NEAR(glass.reflection.x, 0.04, 1e-15);
    EXPECT_NEAR(glass.transmission.x, 0.96, 1e-15);
    EXPECT_EQ(glass.diffuse, dvec3(0));
    EXPECT_EQ(glass.ior, 1.5);
    EXPECT_EQ(whitted_material({.metallic = 0, .roughness = 0, .transmission = 1}).ior, 1);
    const Material half = whitted_material({.base = red, .alpha = 0.5, .metallic = 0, .roughness = 1});
    EXPECT_EQ(half.diffuse, 0.5 * red);
    EXPECT_EQ(half.transmission, dvec3(0.5));
    EXPECT_EQ(half.ior, 1);
    // What does not exist emits nothing, and what is half there emits half.
    EXPECT_EQ(whitted_material({.alpha = 0.25, .emission = red}).emission, 0.25 * red);
    EXPECT_EQ(whitted_material({.alpha = 0, .emission = red}).emission, dvec3(0));
}

TEST(MetallicRoughness, NeverGivesMoreThanArrives) {
    // In uniform light from all directions, a white surface must not reflect more than it receives.
    for (int i = 0; i <= 10; ++i) {
        for (int j = 0; j <= 10; ++j) {
            for (int k = 0; k <= 10; ++k) {
                const Material m =
                    whitted_material({.metallic = i / 10.0, .roughness = j / 10.0, .transmission = k / 10.0});
                EXPECT_LE(m.diffuse.x + m.diffuse_transmission.x + m.reflection.x + m.transmission.x, 1.05)
                    << i << " " << j << " " << k;
            }
        }
    }
}

TEST_F(MeshText, ExtensionsOfMaterialsAreRead) {
    GltfText g;
    g.mesh.replace(g.mesh.find("}}]"), 3, R"(},"material":0}])");
    g.more =
        R"("materials":[{"name":"lamp","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":0,"roughnessFactor":0},)"
        R"("emissiveFactor":[1,0.5,0],"normalTexture":{"index":0},"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":20},)"
        R"("KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":2},)"
        R"("KHR_materials_volume":{"thicknessFactor":1},"KHR_materials_clearcoat":{}}}],)";
    const Scene s = read(g);
    const Material& m = s.materials.at(s.objects.at(0).material);
    EXPECT_EQ(m.name, "lamp");
    EXPECT_EQ(m.emission, dvec3(20, 10, 0));
    EXPECT_EQ(m.ior, 2);
    EXPECT_NEAR(m.reflection.x, 1.0 / 9, 1e-15);
    EXPECT_LT(glm::length(m.transmission - 8.0 / 9 * dvec3(0.5, 0.25, 1)), 1e-15);
    EXPECT_TRUE(notes_have(s, "normalTexture"));
    EXPECT_TRUE(notes_have(s, "KHR_materials_clearcoat"));
}

// Four colours: red and green above, blue and white below.
Image four_colours() {
    Image image(2, 2);
    image.rgb = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    return image;
}

TEST_F(MeshText, PicturesLieAsTheFormatSays) {
    write_image(folder_.path() / "four colours.png", four_colours());
    const std::string png = bytes_of(folder_.path() / "four colours.png");
    const auto document = [&](GltfText& g, const std::string& image) {
        // v runs downwards in glTF, so (0.25, 0.25) is the first texel, which is red.
        const int uv = g.floats({0.25F, 0.25F, 0.75F, 0.25F, 0.25F, 1.75F}, "VEC2");
        g.mesh.replace(g.mesh.find("}}]"), 3, fmt::format(R"(,"TEXCOORD_0":{}}},"material":0}}])", uv));
        g.more =
            R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0,"sampler":0}],)"
            R"("samplers":[{"magFilter":9728}],"images":[{)" +
            image + "}],";
    };
    GltfText by_file, by_data, by_view;
    document(by_file, R"("uri":"four%20colours.png")");
    document(by_data, fmt::format(R"("uri":"data:image/png;base64,{}")", base64(png)));
    const int view = by_view.bytes(png);
    document(by_view, fmt::format(R"("bufferView":{},"mimeType":"image/png")", view));
    const std::vector<Scene> scenes{read("f.gltf", by_file.text()), read("d.gltf", by_data.text()),
                                    read("v.glb", by_view.binary())};
    for (const Scene& s : scenes) {
        const Material& m = s.materials.at(s.objects.at(0).material);
        ASSERT_TRUE(m.colour_texture);
        const auto& uv = mesh_of(s.objects[0]).uvs;
        EXPECT_EQ(m.colour_texture->colour({}, uv[0]), dvec3(1, 0, 0));
        EXPECT_EQ(m.colour_texture->colour({}, uv[1]), dvec3(0, 1, 0));
        EXPECT_EQ(m.colour_texture->colour({}, uv[2]), dvec3(0, 0, 1));  // repeated downwards
    }
}

TEST_F(MeshText, TheDigestCoversWhatIsReferredTo) {
    GltfText g;
    write("a b.bin", g.buffer());
    const std::string text = g.text_with_file("a%20b.bin");
    const Scene before = read("t.gltf", text);
    Sha256 digest;
    digest.add(text);
    digest.add("a%20b.bin " + sha256_of_file(folder_.path() / "a b.bin") + "\n");
    EXPECT_EQ(before.sha256, digest.hex());
    write("a b.bin", g.buffer() + "more");
    EXPECT_NE(read("t.gltf", text).sha256, before.sha256);
    // The SHA-256 of an OBJ scene includes its material library.
    write("m.mtl", "newmtl a\nKd 1 0 0\n");
    const std::string obj = "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const Scene first = read("t.obj", obj);
    EXPECT_EQ(first.materials.at(0).diffuse, dvec3(1, 0, 0));
    write("m.mtl", "newmtl a\nKd 0 1 0\n");
    EXPECT_NE(read("t.obj", obj).sha256, first.sha256);
}

TEST_F(MeshText, NothingOutsideOfTheFolderIsRead) {
    fs::create_directories(folder_.path() / "in");
    const GltfText g;
    write("secret.bin", g.buffer());
    write("secret.mtl", "newmtl a\nKd 1 0 0\n");
    fs::create_symlink(folder_.path() / "secret.bin", folder_.path() / "in/link.bin");
    for (const char* uri : {"../secret.bin", "link.bin", "%2e%2e/secret.bin", "/etc/hostname",
                            "file:///etc/hostname", "http://localhost/a.bin"}) {
        EXPECT_THAT(error("in/t.gltf", g.text_with_file(uri)), HasSubstr("buffers[0]")) << uri;
    }
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_THAT(error("in/t.obj", "mtllib ../secret.mtl\n" + triangle),
                HasSubstr("leads out of the scene's folder"));
    write("in/m.mtl", "newmtl a\nmap_Kd ../secret.png\n");
    EXPECT_THAT(error("in/t.obj", "mtllib m.mtl\nusemtl a\n" + triangle),
                HasSubstr("leads out of the scene's folder"));
}

TEST_F(MeshText, StripsFansIndicesAndSparseValuesAreTriangles) {
    GltfText g;
    const int square = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
    const std::string bytes("\0\1\2\3", 4);
    const int order = g.accessor(bytes, 5121, 4, "SCALAR");
    const int where = g.bytes(std::string("\2\0\0\0", 4));
    const std::vector<float> value{0, 9, 0};
    const int what = g.bytes({reinterpret_cast<const char*>(value.data()), 12});
    const int sparse = g.accessor(
        {reinterpret_cast<const char*>(std::vector<float>{0, 0, 0, 1, 0, 0, 5, 5, 5}.data()), 36}, 5126, 3,
        "VEC3",
        fmt::format(
            R"(,"sparse":{{"count":1,"indices":{{"bufferView":{},"componentType":5121}},"values":{{"bufferView":{}}}}})",
            where, what));
    g.mesh = fmt::format(
        R"({{"primitives":[{{"mode":5,"indices":{1},"attributes":{{"POSITION":{0}}}}},{{"mode":6,"attributes":{{"POSITION":{0}}}}},)"
        R"({{"attributes":{{"POSITION":{2}}}}},{{"mode":1,"attributes":{{"POSITION":{0}}}}}]}})",
        square, order, sparse);
    const Scene s = read(g);
    ASSERT_EQ(s.objects.size(), 3U);
    EXPECT_EQ(s.objects[0].id, s.objects[2].id);
    const auto& strip = mesh_of(s.objects[0]).triangles;
    ASSERT_EQ(strip.size(), 2U);
    EXPECT_EQ(strip[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(strip[1], glm::uvec3(1, 3, 2));  // with the winding of the first triangle
    EXPECT_EQ(mesh_of(s.objects[1]).triangles.size(), 2U);
    EXPECT_EQ(mesh_of(s.objects[2]).positions[2], glm::vec3(0, 9, 0));
    EXPECT_TRUE(notes_have(s, "points and lines"));
}

TEST_F(MeshText, ColoursOfCornersAreMixed) {
    GltfText g;
    const int colours = g.floats({1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
    g.mesh.replace(g.mesh.find("}}]"), 3, fmt::format(R"(,"COLOR_0":{}}}}}])", colours));
    const Scene s = read(g);
    const RayScene rays(s, 0);
    RayBatch batch;
    batch.clear(false);
    const dvec3 from(0.25, 0.5, 1), along(0, 0, -1);
    batch.add(from, along, std::numeric_limits<float>::infinity());
    rays.intersect(batch, false);
    ASSERT_TRUE(batch.hit(0).valid());
    const SurfacePoint p = rays.surface(batch.hit(0), from, along, 1);
    // The colour is interpolated by the barycentric coordinates of the hit.
    EXPECT_LT(glm::length(dvec3(p.colour) - dvec3(0.25, 0.25, 0.5)), 1e-7);
    EXPECT_EQ(surface_colour(s.materials.at(0), p), dvec3(p.colour));
}

TEST_F(MeshText, UnlitSurfacesEmitTheirColoursOfCorners) {
    write_image(folder_.path() / "four colours.png", four_colours());
    for (const bool has_picture : {false, true}) {
        GltfText g;
        const int colours = g.floats({0.5F, 0.25F, 1, 0.5F, 0.25F, 1, 0.5F, 0.25F, 1}, "VEC3");
        // All corners lie at the centre of the first texel, which is red.
        const int uv = g.floats({0.25F, 0.25F, 0.25F, 0.25F, 0.25F, 0.25F}, "VEC2");
        g.mesh.replace(g.mesh.find("}}]"), 3,
                       fmt::format(R"(,"COLOR_0":{},"TEXCOORD_0":{}}},"material":0}}])", colours, uv));
        g.more = fmt::format(R"("materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,1,1,1]{}}},)"
                             R"("emissiveFactor":[1,1,1],"extensions":{{"KHR_materials_unlit":{{}}}}}}],)"
                             R"("textures":[{{"source":0}}],"images":[{{"uri":"four%20colours.png"}}],)",
                             has_picture ? R"(,"baseColorTexture":{"index":0})" : "");
        const Scene s = read(g);
        EXPECT_FALSE(notes_have(s, "metal"));
        const RayScene rays(s, 0);
        RayBatch batch;
        batch.clear(false);
        const dvec3 from(0.25, 0.5, 1), along(0, 0, -1);
        batch.add(from, along, std::numeric_limits<float>::infinity());
        rays.intersect(batch, false);
        ASSERT_TRUE(batch.hit(0).valid());
        const SurfacePoint p = rays.surface(batch.hit(0), from, along, 1);
        const Material& m = s.materials.at(0);
        const dvec3 got = own_radiance(s, m, p, surface_colour(m, p));
        const dvec3 expected = has_picture ? dvec3(0.25, 0, 0) : dvec3(0.25, 0.25, 1);
        EXPECT_LT(glm::length(got - expected), 1e-7) << got.x << " " << got.y << " " << got.z;
    }
}

TEST_F(MeshText, OfAnEmissivePictureThatLiesOtherwiseTheMeanCounts) {
    write_image(folder_.path() / "four colours.png", four_colours());
    GltfText g;
    const int uv = g.floats({0, 0, 1, 0, 0, 1}, "VEC2");
    g.mesh.replace(g.mesh.find("}}]"), 3,
                   fmt::format(R"(,"TEXCOORD_0":{0},"TEXCOORD_1":{0}}},"material":0}}])", uv));
    const auto scene = [&g, this](const std::string& texture) {
        g.more =
            R"("materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0}},)"
            R"("emissiveFactor":[1,0.5,1],"emissiveTexture":)" +
            texture + R"(}],"textures":[{"source":0},{}],"images":[{"uri":"four%20colours.png"}],)";
        return read(g);
    };
    // Of the four colours, two have red, two green and two blue.
    const Scene otherwise = scene(R"({"index":0,"texCoord":1})");
    EXPECT_EQ(otherwise.materials.at(0).emission, dvec3(0.5, 0.25, 0.5));
    EXPECT_FALSE(otherwise.materials.at(0).emission_texture);
    EXPECT_TRUE(notes_have(otherwise, "the mean of it counts"));
    const Scene unread = scene(R"({"index":1,"texCoord":1})");
    EXPECT_EQ(unread.materials.at(0).emission, dvec3(0));
    EXPECT_TRUE(notes_have(unread, "emits nothing"));
    EXPECT_TRUE(scene(R"({"index":0})").materials.at(0).emission_texture);
}

TEST_F(MeshText, TrianglesWithoutAreaAreLeftOut) {
    GltfText g;
    const int p = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 2, 3, 3, 3, 4, 4, 4}, "VEC3");
    g.mesh = fmt::format(R"({{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}})", p);
    const Scene s = read(g);
    EXPECT_EQ(triangles(s), 1U);
    EXPECT_TRUE(notes_have(s, "a triangle without area is left out"));
}

}  // namespace
}  // namespace postlens::test::gltf_surface_test
