// A fixture that reads .toml scenes from text.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <string>
#include <tuple>

#include "core/error.h"
#include "scene/scene.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {

/// The text of one object in three lines.
inline const std::string ball = "[[object]]\nshape = 'sphere'\nradius_m = 1\n";

/// Writes a .toml scene to a folder of its own and reads it.
class TomlText : public testing::Test {
  protected:
    Scene read(const std::string& text, const SceneReadOptions& options = {}) {
        write_bytes(path_, text);
        return read_scene(path_, options);
    }
    // The error message from "LINE:COLUMN: " on. The name of the file in front of it is checked and removed.
    std::string error(const std::string& text) {
        try {
            std::ignore = read(text);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            const std::string what = e.what();
            EXPECT_EQ(what.rfind(path_.string() + ":", 0), 0U) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            return what.substr(path_.string().size() + 1);
        }
        return "no error";
    }
    // The error message for a key, in line 4, of an object that is otherwise valid.
    std::string ball_error(const std::string& line) { return error(ball + line + "\n"); }
    // The only object of a file with this table.
    Object object(const std::string& keys, const SceneReadOptions& options = {}) {
        const Scene s = read("[[object]]\n" + keys, options);
        EXPECT_EQ(s.objects.size(), 1U);
        return s.objects.at(0);
    }
    Camera camera(const std::string& keys, const SceneReadOptions& options = {}) {
        return read(ball + "[[camera]]\n" + keys, options).cameras.at(0);
    }
    Light light(const std::string& keys, const SceneReadOptions& options = {}) {
        return read(ball + "[[light]]\n" + keys, options).lights.at(0);
    }
    Material material(const std::string& keys) {
        return read(ball + "[[material]]\nname = 'm'\n" + keys).materials.at(0);
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "t.toml";
};

/// Compares coordinates to 1e-13, some roundings of values of about 10.
inline void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_NEAR(a.x, b.x, 1e-13);
    EXPECT_NEAR(a.y, b.y, 1e-13);
    EXPECT_NEAR(a.z, b.z, 1e-13);
}

/// The point p, transformed by m.
inline glm::dvec3 at(const glm::dmat4& m, const glm::dvec3& p) {
    return glm::dvec3(m * glm::dvec4(p, 1));
}

}  // namespace postlens::test
