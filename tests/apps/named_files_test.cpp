// No command may overwrite a file that it reads, or write one file twice, for any spelling of the names.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/files/file_identity.h"
#include "tests/support/command_test.h"

namespace postlens::test::named_files_test {
namespace {

namespace fs = std::filesystem;

class NamedFiles : public CommandTest {
  protected:
    std::string scene() {
        std::string path = in("scene.toml");
        fs::copy_file(POSTLENS_SAMPLES "/scenes/bars.toml", path, fs::copy_options::overwrite_existing);
        return path;
    }
    std::string frame() {
        std::string path = in("a.exr");
        EXPECT_EQ(run({"trace", scene(), "-o", path, "--size", "16x9", "--quiet"}).exit_code, 0);
        return path;
    }
    // Checks that the command is rejected and that the file is unchanged.
    void kept(const std::string& path, const std::vector<std::string>& words, const std::string& part) {
        const std::string before = bytes_of(path);
        EXPECT_FALSE(before.empty());
        refused(words, ExitCode::wrong_arguments, part);
        EXPECT_EQ(bytes_of(path), before);
    }
};

TEST(FileIdentity, IsOfTheFileNotOfItsName) {
    const TemporaryFolder folder;
    const fs::path there = folder.path() / "there", none = folder.path() / "none";
    std::ofstream(there) << "x";
    fs::create_symlink("there", folder.path() / "link");
    fs::create_hard_link(there, folder.path() / "hard");
    fs::create_directory(folder.path() / "in");
    fs::create_directory_symlink(folder.path() / "in", folder.path() / "through");
    for (const char* name : {"link", "hard", "./there", "in/../there", "through/../there"})
        EXPECT_EQ(file_identity(folder.path() / name), file_identity(there)) << name;
    EXPECT_NE(file_identity(none), file_identity(there));
    EXPECT_EQ(file_identity(folder.path() / "./none"), file_identity(none));
    EXPECT_EQ(file_identity(folder.path() / "through/none"), file_identity(folder.path() / "in/none"));
    EXPECT_EQ(file_identity("none"), file_identity(fs::current_path() / "none"));
}

TEST_F(NamedFiles, InputsAreNotWritten) {
    const std::string s = scene(), a = frame();
    kept(s, {"trace", s, "-o", s}, "SCENE");
    kept(s, {"render", s, "-o", s, "--spp", "1"}, "SCENE");
    kept(a, {"image", a, "-o", a}, "FRAME");
    kept(a, {"focus", a, "-o", a}, "FRAME");
    kept(a, {"motionblur", a, "-o", a, "--shutter", "0:1"}, "FRAME");
    kept(a, {"shoot", a, "-o", a, "--shutter", "0:1"}, "FRAME");
    kept(a, {"focus", a, "-o", in("o.exr"), "--explain", a}, "--explain");
    kept(s, {"focus", a, "-o", s, "--scene", s}, "--scene");
    kept(a, {"focus", a, "-o", in("./a.exr")}, "./a.exr");
    fs::create_symlink("a.exr", in("link.exr"));
    kept(a, {"focus", a, "-o", in("link.exr")}, "link.exr");
    kept(a, {"focus", in("link.exr"), "-o", a}, "a.exr");
    kept(s, {"motionblur", a, "-o", s, "--paths", s}, "--paths");
    kept(s, {"motionblur", a, "-o", s, "--shutter-curve", s}, "--shutter-curve");
    kept(a, {"focus", s, "-o", a, "--impulse", "image:" + a}, "--impulse");
    for (const char* output : {"--map", "--side-by-side", "--map-causes"}) {
        kept(a, {"compare", a, in("r.exr"), output, a}, output);
        kept(a, {"compare", in("r.exr"), a, output, a}, "REFERENCE");
        for (const char* input : {"--noise", "--pinhole", "--frame", "--scene"})
            kept(a, {"compare", in("p.exr"), in("r.exr"), output, a, input, a}, input);
    }
    const std::string lens = in("lens.toml");
    fs::copy_file(POSTLENS_SAMPLES "/lenses/double_gauss.toml", lens);
    kept(lens, {"lens", "show", lens, "-o", lens}, "FILE");
    for (const char* output : {"-o", "--curves", "--impulse"})
        kept(lens, {"lens", "trace", lens, output, lens}, "FILE");
    kept(a, {"lens", "psf", a, "--impulse", "image:" + a}, "--impulse");
}

TEST_F(NamedFiles, NorWhatASceneRefersTo) {
    const std::string picture = in("t.exr"), half = in("t.a.exr"), frame = in("frame.exr");
    ASSERT_EQ(run({"render", scene(), "-o", picture, "--spp", "1", "--size", "16x9", "--quiet"}).exit_code,
              0);
    fs::copy_file(picture, half);
    const auto textured = [&](const std::string& file) {
        std::string path = in("textured.toml");
        std::ofstream(path)
            << "[scene]\n[[camera]]\nfocal_length_mm = 50\n[[texture]]\nname = 't'\nkind = 'image'\nfile = '"
            << file
            << "'\n[[material]]\nname = 'm'\nemission_texture = 't'\n"
               "[[object]]\nshape = 'rectangle'\nmaterial = 'm'\ncorner_m = [-1, -1, "
               "-3]\nedge_u_m = [2, 0, 0]\nedge_v_m = [0, 2, 0]\n";
        return path;
    };
    std::string s = textured("t.exr");
    kept(picture, {"trace", s, "-o", picture}, "t.exr");
    kept(picture, {"render", s, "-o", picture, "--spp", "1"}, "t.exr");
    ASSERT_EQ(run({"trace", s, "-o", frame, "--size", "16x9", "--quiet"}).exit_code, 0);
    kept(picture,
         {"focus", frame, "-o", picture, "--scene", s, "--method", "hybrid", "--f-number", "2", "--focus",
          "2"},
         "t.exr");
    kept(picture,
         {"focus", frame, "-o", in("o.exr"), "--explain", picture, "--scene", s, "--method", "auto",
          "--f-number", "2", "--focus", "2"},
         "t.exr");
    kept(picture,
         {"compare", frame, frame, "--map-causes", picture, "--frame", frame, "--scene", s, "--f-number", "2",
          "--focus", "2"},
         "t.exr");
    s = textured("t.a.exr");
    kept(half, {"render", s, "-o", picture, "--spp", "2", "--halves"}, "t.a.exr");
}

TEST_F(NamedFiles, NoFileIsWrittenTwice) {
    const std::string a = frame(), o = in("o.exr");
    refused({"focus", a, "-o", o, "--explain", in("./o.exr")}, ExitCode::wrong_arguments, "--explain");
    refused({"compare", a, a, "--map", o, "--side-by-side", o}, ExitCode::wrong_arguments, "--map");
    refused({"lens", "psf", o, "--profile", o}, ExitCode::wrong_arguments, "--profile");
    refused({"lens", "trace", POSTLENS_SAMPLES "/lenses/double_gauss.toml", "-o", in("x.svg"), "--curves",
             in("x.svg")},
            ExitCode::wrong_arguments, "--curves");
}

TEST_F(NamedFiles, OfEveryFrameOfARange) {
    const std::string a = frame();
    fs::rename(a, in("f.0002.exr"));
    const std::string two = in("f.0002.exr");
    const auto range = [&](const std::string& input, const std::string& output) {
        return std::vector<std::string>{"focus", in(input), "-o", in(output), "--frames", "1-3"};
    };
    kept(two, range("f.%04d.exr", "f.%04d.exr"), "FRAME");
    kept(two, range("f.%04d.exr", "f.####.exr"), "FRAME");
    auto with_aperture = range("g.%d.exr", "f.%04d.exr");
    with_aperture.insert(with_aperture.end(), {"--impulse", "image:" + two});
    kept(two, with_aperture, "--impulse");
}

TEST_F(NamedFiles, NorThoseThatAFolderIsToHold) {
    const std::string s = scene(), a = frame();
    fs::rename(a, in("pull.0002.exr"));
    const std::string two = in("pull.0002.exr");
    kept(two, {"sweep", two, "-o", in("."), "--focus", "1,2", "--f-number", "2", "--frames", "pull.%04d"},
         "pull.0002.exr");
    fs::rename(two, in("reference.exr"));
    kept(in("reference.exr"),
         {"chart", s, "-o", in("."), "--size", "16x9", "--no-plots", "--f-number", "2", "--focus", "2",
          "--reference", in("reference.exr")},
         "reference.exr");
    EXPECT_EQ(run({"sweep", in("reference.exr"), "-o", in("."), "--focus", "1", "--f-number", "2", "--quiet"})
                  .exit_code,
              0);
}

}  // namespace
}  // namespace postlens::test::named_files_test
