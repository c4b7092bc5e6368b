// The .toml scene format: every error says where it is and what was expected.
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "scene/scene.h"
#include "scene/toml/toml_scene.h"
#include "tests/scene/toml_text.h"

namespace postlens::test::toml_errors_test {
namespace {

using glm::dvec3;

TEST_F(TomlText, UnknownKeysNameTheNearestKnownOne) {
    EXPECT_EQ(error("[[objects]]\n"),
              "1:3: scene file: unknown key (got 'objects'; nearest known key: 'object')");
    EXPECT_EQ(error("[scene]\nbackgruond = 1\n"),
              "2:1: [scene]: unknown key (got 'backgruond'; nearest known key: 'background')");
    EXPECT_EQ(error("[[material]]\nname = 'm'\ncolor = 1\n"),
              "3:1: material 'm': unknown key (got 'color'; nearest known key: 'colour')");
    EXPECT_EQ(error("[[texture]]\nname = 't'\nkind = 'checker'\nsize = 1\n"),
              "4:1: texture 1: unknown key (got 'size'; nearest known key: 'size_m')");
    EXPECT_EQ(error("[[texture]]\nname = 't'\nkind = 'checker'\nsize_m = 1\nfile = 'x'\n"),
              "5:1: texture 't': unknown key (got 'file'; nearest known key: 'name')");
    EXPECT_EQ(error("[[camera]]\nfocal_lenght_mm = 3\n" + ball),
              "2:1: camera 1: unknown key (got 'focal_lenght_mm'; nearest known key: 'focal_length_mm')");
    EXPECT_EQ(error("[[light]]\nkin = 'point'\n" + ball),
              "2:1: light 1: unknown key (got 'kin'; nearest known key: 'kind')");
    EXPECT_EQ(error(ball + "[[light]]\nkind = 'point'\nposition_m = [0, 0, 0]\ncone_degrees = 3\n")
                  .rfind("7:1: light 1: unknown key", 0),
              0U);
    EXPECT_EQ(ball_error("raduis_m = 2"),
              "4:1: object 'sphere 1': unknown key (got 'raduis_m'; nearest known key: 'radius_m')");
    EXPECT_EQ(ball_error("  size_m = 2").rfind("4:3: object 'sphere 1': unknown key (got 'size_m'", 0), 0U);
    EXPECT_EQ(error("[[object]]\nshpae = 'sphere'\n"),
              "2:1: object 1: unknown key (got 'shpae'; nearest known key: 'shape')");
    EXPECT_EQ(
        ball_error("keys = [{ time_s = 0, tranlate_m = [0, 0, 0] }]"),
        "4:23: object 'sphere 1': key 1: unknown key (got 'tranlate_m'; nearest known key: 'translate_m')");
    EXPECT_EQ(ball_error("repeat = { cuont = 2 }"),
              "4:12: object 'sphere 1': repeat: unknown key (got 'cuont'; nearest known key: 'count')");
    // The first unknown key in the order of the file is reported.
    EXPECT_EQ(ball_error("zzz = 1\naaa = 2").rfind("4:1: object 'sphere 1': unknown key (got 'zzz'", 0), 0U);
}

TEST_F(TomlText, UnknownWordsNameTheNearestKnownOne) {
    EXPECT_EQ(error("[[object]]\nshape = 'sphrere'\n"),
              "2:9: object 1: 'shape' is unknown (got 'sphrere'; nearest known: 'sphere'; expected one of "
              "sphere, box, disc, "
              "rectangle, plane, cylinder, cone, mesh, instance)");
    EXPECT_EQ(error("[[material]]\nname = 'clay'\n" + ball + "material = 'claz'\n"),
              "6:12: object 'sphere 1': no material has this name (got 'claz'; nearest known name: 'clay')");
    EXPECT_EQ(ball_error("material = 'clay'"),
              "4:12: object 'sphere 1': no material has this name (got 'clay'; the scene has none)");
    EXPECT_EQ(error("[[material]]\nname = 'm'\ncolour_texture = 'x'\n"),
              "3:18: material 'm': no texture has this name (got 'x'; the scene has none)");
    EXPECT_EQ(error(ball + "name = 'b'\n[[object]]\nshape = 'instance'\nof = 'c'\n"),
              "7:6: object 'instance 2': no object above has this name (got 'c'; nearest known name: 'b'); "
              "an instance stands "
              "below what it repeats");
    EXPECT_EQ(error("[[light]]\nkind = 'sport'\n" + ball),
              "2:8: light 1: 'kind' is unknown (got 'sport'; nearest known: 'spot'; expected one of point, "
              "directional, spot, sphere, rectangle)");
}

TEST_F(TomlText, MissingKeysAreNamed) {
    EXPECT_EQ(error("[[object]]\nname = 'x'\n"), "1:1: object 1: has no 'shape' (expected one)");
    EXPECT_EQ(error("\n[[object]]\nshape = 'sphere'\n"),
              "2:1: object 'sphere 1': has no 'radius_m' (expected one)");
    EXPECT_EQ(error("[[object]]\nshape = 'instance'\n"),
              "1:1: object 'instance 1': has no 'of' (expected one)");
    EXPECT_EQ(error("[[material]]\nior = 1\n"), "1:1: material 1: has no 'name' (expected one)");
    EXPECT_EQ(error("[[texture]]\nname = 't'\n"), "1:1: texture 't': has no 'kind' (expected one)");
    EXPECT_EQ(error(ball + "[[light]]\n"), "4:1: light 1: has no 'kind' (expected one)");
    EXPECT_EQ(ball_error("keys = [{ translate_m = [0, 0, 0] }]"),
              "4:9: object 'sphere 1': key 1: has no 'time_s' (expected one)");
    EXPECT_EQ(ball_error("repeat = { step_m = [0, 0, 0] }"),
              "4:10: object 'sphere 1': repeat: has no 'count' (expected one)");
    EXPECT_EQ(ball_error("repeat = { count = 2 }"),
              "4:10: object 'sphere 1': repeat: has no 'step_m' (expected one)");
}

TEST_F(TomlText, WrongTypesAreNamed) {
    EXPECT_EQ(error("[[object]]\nshape = 'sphere'\nradius_m = 'big'\n"),
              "3:12: object 'sphere 1': 'radius_m' is a text (got 'big'; expected a number)");
    EXPECT_EQ(ball_error("translate_m = 1"),
              "4:15: object 'sphere 1': 'translate_m' is a number (got 1; expected an array of 3 numbers)");
    EXPECT_EQ(ball_error("translate_m = [1, 2]"),
              "4:15: object 'sphere 1': 'translate_m' has the wrong length (got 2; expected 3 numbers)");
    EXPECT_EQ(ball_error("translate_m = [1, true, 2]"),
              "4:19: object 'sphere 1': 'translate_m' is true or false (got true; expected a number)");
    EXPECT_EQ(ball_error("scale = 'x'"),
              "4:9: object 'sphere 1': 'scale' is a text (got 'x'; expected a number or 3 numbers)");
    EXPECT_EQ(ball_error("hidden = 1"),
              "4:10: object 'sphere 1': 'hidden' is a number (got 1; expected true or false)");
    EXPECT_EQ(ball_error("name = 2024-01-01"),
              "4:8: object 1: 'name' is a date or time (got a date or time; expected a text)");
    EXPECT_EQ(ball_error("name = ''"),
              "4:8: object 1: 'name' is not a usable text (got ''; expected 1 to 255 printable characters)");
    EXPECT_EQ(
        ball_error("name = \"a\\u0007\"").rfind("4:8: object 1: 'name' is not a usable text (got 'a?'", 0),
        0U);
    EXPECT_EQ(ball_error("keys = 3"),
              "4:8: object 'sphere 1': 'keys' is a number (got 3; expected an array of tables)");
    EXPECT_EQ(ball_error("keys = [3]"),
              "4:9: object 'sphere 1': 'keys' holds a number (got 3; expected tables)");
    EXPECT_EQ(ball_error("repeat = 3"),
              "4:10: object 'sphere 1': 'repeat' is a number (got 3; expected a table)");
    EXPECT_EQ(error("object = 1\n"),
              "1:10: scene file: 'object' is a number (got 1; expected an array of tables)");
    EXPECT_EQ(error("scene = 1\n"), "1:9: scene file: 'scene' is a number (got 1; expected a table)");
    EXPECT_EQ(error("[[camera]]\nwidth_px = 1.5\n" + ball),
              "2:12: camera 1: 'width_px' is not whole (got 1.5; expected a whole number)");
}

TEST_F(TomlText, NumbersOutOfRangeAreRefused) {
    const std::string start = "[[object]]\nshape = 'sphere'\nradius_m = ";
    const std::string range = "; expected 1e-12 to 1e+12)";
    for (const auto& [text, shown] :
         {std::pair("0", "0"), std::pair("-1", "-1"), std::pair("inf", "inf"), std::pair("nan", "nan"),
          std::pair("1e300", "1e+300"), std::pair("1e-300", "1e-300")}) {
        EXPECT_EQ(error(start + text + "\n"),
                  std::string("3:12: object 'sphere 1': 'radius_m' is out of range (got ") + shown + range);
    }
    EXPECT_EQ(ball_error("translate_m = [0, nan, 0]"),
              "4:19: object 'sphere 1': 'translate_m' is out of range (got nan; expected -1e+12 to 1e+12)");
    EXPECT_EQ(ball_error("scale = 0"),
              "4:9: object 'sphere 1': 'scale' is out of range (got 0; expected 1e-09 to 1e+09)");
    EXPECT_EQ(
        ball_error("scale = [1, -1, 1]").rfind("4:13: object 'sphere 1': 'scale' is out of range (got -1", 0),
        0U);
    EXPECT_EQ(error("[[material]]\nname = 'm'\nreflection = 1.5\n"),
              "3:14: material 'm': 'reflection' is out of range (got 1.5; expected 0 to 1)");
    EXPECT_EQ(error("[[material]]\nname = 'm'\nemission = [1, 2, -3]\n"),
              "3:19: material 'm': 'emission' is out of range (got -3; expected 0 to 1e+12)");
    EXPECT_EQ(error("[[material]]\nname = 'm'\nior = 0\n"),
              "3:7: material 'm': 'ior' is out of range (got 0; expected 0.01 to 100)");
    EXPECT_EQ(error("[scene]\ntime_s = inf\n").rfind("2:10: [scene]: 'time_s' is out of range (got inf", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nf_number = 0\n" + ball),
              "2:12: camera 1: 'f_number' is out of range (got 0; expected 0.001 to 1e+06 or inf)");
    EXPECT_EQ(error("[[camera]]\nfocus_m = -1\n" + ball)
                  .rfind("2:11: camera 1: 'focus_m' is out of range (got -1", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nheight_px = 0\n" + ball),
              "2:13: camera 1: 'height_px' is out of range (got 0; expected 1 to 65536)");
    EXPECT_EQ(error("[[camera]]\nvertical_fov_degrees = 180\n" + ball),
              "2:24: camera 1: 'vertical_fov_degrees' is out of range (got 180; expected 0.001 to 179)");
    EXPECT_EQ(error(ball + "scale = 1e9\ntranslate_m = [9e11, 0, 0]\n[[object]]\nshape = 'sphere'\nradius_m "
                           "= 1e6\nscale = 1e9\n"),
              " object 'sphere 2' reaches too far (expected at most 1000000000000 m from the origin)");
    EXPECT_EQ(ball_error("repeat = { count = [1000, 1000, 1000], step_m = [1, 1, 1] }"),
              "4:20: object 'sphere 1': repeat: 'count' makes too many copies (got 1000000000; expected at "
              "most 1000000)");
    EXPECT_EQ(ball_error("repeat = { count = [1.5, 1, 1], step_m = [1, 1, 1] }"),
              "4:20: object 'sphere 1': repeat: 'count' is not whole (got 1.5; expected whole numbers)");
    EXPECT_EQ(ball_error("repeat = { at_m = [] }"),
              "4:19: object 'sphere 1': repeat: 'at_m' is empty (expected at least one place)");
}

TEST_F(TomlText, ContradictionsAreRefused) {
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]\nscale = 2"),
              "5:9: object 'sphere 1': 'matrix' and 'scale' cannot stand together (expected one of them)");
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' flattens or mirrors", 0),
              0U);
    EXPECT_EQ(ball_error("matrix = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' flattens or mirrors", 0),
              0U);
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' is not affine (got 1 rows", 0),
              0U);
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' is not affine", 0),
              0U);
    EXPECT_EQ(ball_error("rotate_degrees = 10"),
              "4:18: object 'sphere 1': one angle needs 'rotate_axis' (expected it, or three angles about x, "
              "y, z)");
    EXPECT_EQ(ball_error("rotate_axis = [0, 0, 1]"),
              "4:15: object 'sphere 1': 'rotate_axis' needs 'rotate_degrees' (expected both or neither)");
    EXPECT_EQ(ball_error("rotate_degrees = [1, 2, 3]\nrotate_axis = [0, 0, 1]")
                  .rfind("5:15: object 'sphere 1': 'rotate_axis' stands beside", 0),
              0U);
    EXPECT_EQ(ball_error("rotate_degrees = 1\nrotate_axis = [0, 0, 0]")
                  .rfind("5:15: object 'sphere 1': 'rotate_axis' has no direction", 0),
              0U);
    EXPECT_EQ(ball_error("quaternion = [0, 0, 0, 0]")
                  .rfind("4:14: object 'sphere 1': 'quaternion' has no length", 0),
              0U);
    EXPECT_EQ(ball_error("hidden = true"),
              "4:10: object 'sphere 1': a hidden object without a name can never be seen");
    EXPECT_EQ(error(ball + "name = 'b'\nhidden = true\n"),
              " the scene has no objects (expected at least one that is not hidden)");
    EXPECT_EQ(error(ball + "name = 'b'\n" + ball + "name = 'b'\n"),
              "8:8: object 'b': two objects have the name 'b'");
    EXPECT_EQ(error("[[material]]\nname = 'm'\n[[material]]\nname = 'm'\n"),
              "4:8: material 'm': two materials have the name 'm'");
    EXPECT_EQ(error("[[camera]]\nname = 'm'\n[[camera]]\nname = 'm'\n" + ball),
              "4:8: camera 'm': two of a kind have the name 'm'");
    EXPECT_EQ(error("[[camera]]\nfocal_length_mm = 50\nvertical_fov_degrees = 20\n" + ball),
              "3:24: camera 1: 'focal_length_mm' and 'vertical_fov_degrees' cannot stand together (expected "
              "one of them)");
    EXPECT_EQ(error("[[camera]]\northographic_width_m = 2\n" + ball)
                  .rfind("2:24: camera 1: 'orthographic_width_m' has no meaning", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nprojection = 'orthographic'\nfocal_length_mm = 2\n" + ball)
                  .rfind("3:19: camera 1: 'focal_length_mm' has no meaning", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nlook_at_m = [0, 0, 0]\n" + ball)
                  .rfind("1:1: camera 1: 'position_m', the view's direction and 'up' do not span", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nlook_along = [0, 1, 0]\n" + ball)
                  .rfind("1:1: camera 1: 'position_m', the view's direction and 'up' do not span", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nkeys = [{ time_s = 0, scale = 2 }]\n" + ball)
                  .rfind("2:23: camera 1: key 1: unknown key (got 'scale'", 0),
              0U);
    EXPECT_EQ(
        error(ball + "[[light]]\nkind = 'spot'\nposition_m = [0, 0, 0]\ndirection = [0, 0, 1]\ncone_degrees "
                     "= 20\ncone_soft_degrees = 30\n"),
        "9:21: light 1: 'cone_soft_degrees' is out of range (got 30; expected at most 'cone_degrees', 20)");
    EXPECT_EQ(error(ball + "[[light]]\nkind = 'point'\nposition_m = [0, 0, 0]\nattenuation = [0, 0, 0]\n")
                  .rfind("7:15: light 1: 'attenuation' is 0 everywhere", 0),
              0U);
}

TEST_F(TomlText, ShapesWithoutExtentAreRefused) {
    const auto shape = [&](const std::string& keys) { return error("[[object]]\nshape = " + keys + "\n"); };
    EXPECT_EQ(shape("'box'\nmin_m = [0, 0, 0]\nmax_m = [1, 0, 1]"),
              "4:9: object 'box 1': 'max_m' does not exceed 'min_m' on every axis (got a size of 1, 0, 1 m)");
    EXPECT_EQ(shape("'box'\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\nsize_m = 1"),
              "5:10: object 'box 1': 'min_m' and 'size_m' cannot stand together (expected one of them)");
    EXPECT_EQ(shape("'disc'\nnormal = [0, 0, 1]\nradius_m = 1\ninner_radius_m = 1"),
              "5:18: object 'disc 1': 'inner_radius_m' is out of range (got 1 m; expected less than "
              "'radius_m', 1 m)");
    EXPECT_EQ(shape("'rectangle'\ncorner_m = [0, 0, 0]\nedge_u_m = [1, 0, 0]\nedge_v_m = [2, 0, 0]"),
              "1:1: object 'rectangle 1': 'edge_u_m' and 'edge_v_m' span no area (expected two edges of "
              "different directions)");
    EXPECT_EQ(shape("'cylinder'\nbase_m = [0, 0, 0]\napex_m = [0, 0, 0]\nradius_m = 1"),
              "4:10: object 'cylinder 1': 'apex_m' and 'base_m' coincide (expected a distance between them)");
    EXPECT_EQ(shape("'cone'\nbase_m = [0, 0, 0]\napex_m = [0, 0, 1]\nbase_radius_m = 0"),
              "5:17: object 'cone 1': both radii are 0 (expected one above)");
    EXPECT_EQ(
        shape("'plane'\nnormal = [0, 0, 0]").rfind("3:10: object 'plane 1': 'normal' has no direction", 0),
        0U);
}

TEST_F(TomlText, MeshErrorsNameTheFace) {
    const auto mesh = [&](const std::string& keys) {
        return error("[[object]]\nshape = 'mesh'\npositions_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n" + keys +
                     "\n");
    };
    EXPECT_EQ(
        mesh("faces = [[0, 1, 3]]"),
        "4:9: object 'mesh 1': face 0 has an index out of range (got 3; expected a whole number of 0 to 2)");
    EXPECT_EQ(mesh("faces = [[0, 1, -1]]")
                  .rfind("4:9: object 'mesh 1': face 0 has an index out of range (got -1", 0),
              0U);
    EXPECT_EQ(mesh("faces = [[0, 1, 1.5]]")
                  .rfind("4:9: object 'mesh 1': face 0 has an index out of range (got 1.5", 0),
              0U);
    EXPECT_EQ(mesh("faces = [[0, 1, 2], [0, 1, 1]]"),
              "4:9: object 'mesh 1': face 1 has no area (expected a simple polygon)");
    EXPECT_EQ(mesh("faces = [[0, 1]]"),
              "4:10: object 'mesh 1': a row of 'faces' has the wrong length (got 2; expected 3 to 4096)");
    EXPECT_EQ(mesh("faces = []"), "4:9: object 'mesh 1': the mesh is empty (expected positions and faces)");
    EXPECT_EQ(mesh("faces = [[0, 1, 2]]\nnormals = [[0, 0, 1]]"),
              "5:11: object 'mesh 1': 'normals' has the wrong length (got 1; expected one per position, 3)");
    EXPECT_EQ(mesh("faces = [[0, 1, 2]]\nuvs = [[0, 0, 1]]"),
              "5:8: object 'mesh 1': a row of 'uvs' has the wrong length (got 3; expected 2)");
    EXPECT_EQ(mesh("faces = [[0, 1, 2]]\nnormals = [[0, 0, 1], [0, 0, 0], [0, 0, 1]]"),
              "5:11: object 'mesh 1': a normal has no length (got 0, 0, 0)");
}

TEST_F(TomlText, MotionErrors) {
    EXPECT_EQ(ball_error("keys = [{ time_s = 1 }, { time_s = 1 }]"),
              "4:36: object 'sphere 1': key 2: 'time_s' does not grow (got 1 s after 1 s)");
    EXPECT_EQ(
        ball_error("keys = [{ time_s = 0 }, { time_s = 1, rotate_degrees = 360, rotate_axis = [0, 1, 0] }]"),
        "4:25: object 'sphere 1': key 2: the turn since the key before is ambiguous (got 360 degrees; "
        "expected less than "
        "180: add a key between)");
    EXPECT_EQ(ball_error("keys = [{ time_s = 0 }, { time_s = 1, rotate_degrees = [0, 179, 0] }]"),
              "no error");
    EXPECT_EQ(error(ball + "name = 'b'\nkeys = [{ time_s = 0 }]\n[[object]]\nshape = 'instance'\nof = 'b'\n"),
              "8:6: object 'instance 2': 'b' moves and cannot be instanced (expected 'keys' on the instance "
              "instead)");
}

TEST_F(TomlText, FresnelIsAskedForAndMakesNoMirrorOfWhatIsNone) {
    EXPECT_FALSE(material("reflection = 0.04").fresnel);
    const Material m = material("reflection = 0.04\nfresnel = true");
    EXPECT_TRUE(m.fresnel);
    EXPECT_EQ(m.reflection_grazing, dvec3(1));
    EXPECT_FALSE(m.has_highlight());
    EXPECT_FALSE(material("specular = 0.3\nfresnel = true").reflects());
    EXPECT_NE(error(ball + "material = 'm'\n[[material]]\nname = 'm'\nfresnel = 1\n").find("fresnel"),
              std::string::npos);
}

TEST_F(TomlText, InstancesOfInstancesCannotGrowWithoutBound) {
    std::string text = ball + "name = 'o0'\nhidden = true\n";
    for (int i = 1; i < 12; ++i) {
        const std::string below = "'o" + std::to_string(i - 1) + "'";
        text += "[[object]]\nshape = 'instance'\nhidden = true\nname = 'o" + std::to_string(i) + "'\nof = [" +
                below + ", " + below + ", " + below + ", " + below + ", " + below + ", " + below + ", " +
                below + ", " + below + "]\n";
    }
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(error(text).find("the scene has too many shapes"), std::string::npos);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(TomlText, SyntaxErrorsHaveLineAndColumn) {
    EXPECT_EQ(error("[scene\n").rfind("1:7: not valid TOML: ", 0), 0U);
    EXPECT_EQ(error("a = 1\na = 2\n").rfind("2:5: not valid TOML: ", 0), 0U);
    EXPECT_EQ(error("[scene]\nname = 'open\n").rfind("2:", 0), 0U);
    EXPECT_EQ(error("x = \xFF\xFE\n").find("not valid TOML") != std::string::npos, true);
    EXPECT_EQ(error("x = " + std::string(100000, '[')).find("not valid TOML") != std::string::npos, true);
    EXPECT_EQ(error(""), " the scene has no objects (expected at least one that is not hidden)");
}

TEST_F(TomlText, EveryTruncationIsAnErrorOrAScene) {
    const std::string text =
        "[scene]\nname = 'x'\n[[material]]\nname = 'm'\ndiffuse = [1, 0.5, 0]\n" + ball +
        "material = 'm'\nkeys = [{ time_s = 0 }, { time_s = 1.5, translate_m = [0, 1, 0] }]\n";
    int errors = 0;
    for (std::size_t length = 0; length < text.size(); ++length) {
        errors += error(text.substr(0, length)) == "no error" ? 0 : 1;
    }
    EXPECT_GT(errors, 100);
}

TEST_F(TomlText, LargeGarbageFailsAtOnce) {
    const auto start = std::chrono::steady_clock::now();
    std::ofstream(path_, std::ios::binary) << "x = 1\n";
    std::filesystem::resize_file(path_, 100'000'000);
    EXPECT_THROW(std::ignore = read_scene(path_), Error);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
    std::filesystem::resize_file(path_,
                                 largest_toml_bytes);  // small enough to be parsed, but filled with zeros
    EXPECT_THROW(std::ignore = read_scene(path_), Error);
}

}  // namespace
}  // namespace postlens::test::toml_errors_test
