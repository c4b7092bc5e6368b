// A fixture that reads scenes of meshes from text, and queries of their objects.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <tuple>
#include <variant>

#include "core/error.h"
#include "scene/scene.h"
#include "tests/scene/gltf_text.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {

/// The mesh of an object, which must be one.
inline const Mesh& mesh_of(const Object& object) {
    return *std::get<std::shared_ptr<const Mesh>>(object.shape);
}

/// The number of triangles of all objects, which must be meshes.
inline std::size_t triangles(const Scene& scene) {
    std::size_t sum = 0;
    for (const Object& o : scene.objects) sum += mesh_of(o).triangles.size();
    return sum;
}

/// The transform of an object from its own frame to the world at time t_s.
inline glm::dmat4 world_at(const Object& o, double t_s) {
    return o.keys.empty() ? o.world_from_object : transform_at(o.keys, t_s) * o.motion_base;
}

/// The world position of point p of an object at time t_s.
inline glm::dvec3 moved(const Object& o, double t_s, const glm::dvec3& p) {
    return glm::dvec3(world_at(o, t_s) * glm::dvec4(p, 1));
}

/// Whether a note of the scene contains `text`.
inline bool notes_have(const Scene& scene, const std::string& text) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

/// Writes mesh files to a folder of its own and reads them as scenes.
class MeshText : public testing::Test {
  protected:
    std::filesystem::path write(const std::string& name, const std::string& bytes) {
        write_bytes(folder_.path() / name, bytes);
        return folder_.path() / name;
    }
    Scene read(const std::string& name, const std::string& bytes, const SceneReadOptions& options = {}) {
        return read_scene(write(name, bytes), options);
    }
    Scene read(const GltfText& g, const SceneReadOptions& options = {}) {
        return read("t.gltf", g.text(), options);
    }
    // The error message without the file's folder. It must be a single line, with exit code 3.
    std::string error(const std::string& name, const std::string& bytes) {
        try {
            std::ignore = read(name, bytes);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            std::string what = e.what();
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            EXPECT_EQ(what.rfind((folder_.path() / name).string() + ":", 0), 0U) << what;
            return what.substr(folder_.path().string().size() + 1);
        }
        return "no error";
    }
    std::string error(const GltfText& g) { return error("t.gltf", g.text()); }

    TemporaryFolder folder_;
};

}  // namespace postlens::test
