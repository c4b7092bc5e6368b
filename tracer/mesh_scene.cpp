#include "tracer/mesh_scene.h"

#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "core/text_file.h"
#include "records/scene_limits.h"
#include "records/srgb.h"
#include "tracer/mesh_files.h"
#include "tracer/mesh_materials.h"
#include "tracer/ply_check.h"
#include "tracer/scene_defaults.h"
#include "tracer/toml_objects.h"
#include "tracer/triangulate.h"

namespace postlens {
namespace {

using glm::dvec3;

std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7F; }, ' ');
    return text.substr(0, 200);
}

class MeshReader {
  public:
    MeshReader(const std::filesystem::path& path, const SceneReadOptions& options)
        : path_(path), unit_(options.metres_per_unit) {
        std::string ending = path.extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        is_ply_ = ending == ".ply";
        scene_.name = path.stem().string();
        scene_.ambient_light = dvec3(mesh_ambient_light);
    }

    Scene read() {
        const std::string bytes = read_text_file(path_, largest_mesh_file_bytes);
        if (is_ply_) check_ply(bytes, path_.string());
        // The importer deletes it.
        auto* const files = new MeshFiles(path_, is_ply_ ? bytes : as_utf8(bytes));
        Assimp::Importer importer;
        importer.SetIOHandler(files);
        const aiScene* found = import(importer);
        for (const std::string& name : files->outside()) {
            fail(ExitCode::invalid_input,
                 "{}: a material library leads out of the scene's folder (got {}; expected a path inside it)",
                 path_.string(), excerpt(name));
        }
        if (!files->missing().empty()) {
            notes_.add(
                fmt::format("the material library {} cannot be read", excerpt(files->missing().front())));
        }
        std::vector<ReferredFile> referred = files->opened();
        MeshMaterials materials(path_, referred, notes_);
        add_node(*found, *found->mRootNode, materials);
        notes_.append_to(scene_.notes, path_);
        name_sources(bytes, referred, scene_);
        complete_scene(scene_, path_, answers_to_lights(scene_), 1, open_side(scene_));
        return std::move(scene_);
    }

  private:
    const aiScene* import(Assimp::Importer& importer) const {
        std::string why;
        try {
            if (const aiScene* found = importer.ReadFile(path_.string(), 0); found && found->mRootNode)
                return found;
            why = importer.GetErrorString();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& e) {  // assimp catches most of its own
            why = e.what();
        }
        fail(ExitCode::invalid_input, "{}: cannot be read ({})", path_.string(), one_line(why));
    }

    // Trees of these two formats are two levels deep.
    void add_node(const aiScene& from, const aiNode& node, MeshMaterials& materials) {
        if (node.mNumMeshes > 0) {
            const std::string name = node.mName.C_Str();
            const bool is_nameless = name.empty() || name == "defaultobject";
            const std::size_t before = scene_.objects.size();
            for (unsigned i = 0; i < node.mNumMeshes; ++i) {
                const aiMesh& mesh = *from.mMeshes[node.mMeshes[i]];
                Mesh read = read_mesh(mesh);
                if (read.triangles.empty()) continue;
                Object object;
                object.name = printable_name(is_nameless ? scene_.name : name, "mesh");
                object.id = id_ + 1;
                object.material = material_of(from, mesh.mMaterialIndex, materials);
                object.shape = std::make_shared<const Mesh>(std::move(read));
                scene_.objects.push_back(std::move(object));
            }
            if (scene_.objects.size() > before) ++id_;
            if (scene_.objects.size() > largest_shape_count) {
                fail(ExitCode::invalid_input, "{}: has too many objects (expected at most {})",
                     path_.string(), largest_shape_count);
            }
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(from, *node.mChildren[i], materials);
    }

    std::size_t material_of(const aiScene& from, unsigned index, MeshMaterials& materials) {
        const auto [at, is_new] = materials_.try_emplace(index, scene_.materials.size());
        if (is_new) {
            const aiMaterial& m = *from.mMaterials[index];
            const bool is_made = is_ply_ || std::string_view(m.GetName().C_Str()) == AI_DEFAULT_MATERIAL_NAME;
            Material made = MeshMaterials::plain();
            Material read = materials.read(m);
            if (is_made) {
                made.colour_texture = read.colour_texture;
                read = std::move(made);
            }
            scene_.materials.push_back(std::move(read));
        }
        return at->second;
    }

    Mesh read_mesh(const aiMesh& from) {
        Mesh out;
        std::vector<bool> usable(from.mNumVertices);
        out.positions.reserve(from.mNumVertices);
        for (unsigned i = 0; i < from.mNumVertices; ++i) {
            const aiVector3D& v = from.mVertices[i];
            const dvec3 p = unit_ * dvec3(v.x, v.y, v.z);
            usable[i] = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= largest_length_m && p == p;
            out.positions.emplace_back(usable[i] ? p : dvec3(0));
        }
        read_corners(from, out);
        for (unsigned i = 0; i < from.mNumFaces; ++i) add_face(from.mFaces[i], usable, out);
        return out;
    }

    void read_corners(const aiMesh& from, Mesh& out) {
        const auto finite = [](const aiVector3D& v) {
            return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
        };
        for (unsigned i = 0; from.HasNormals() && i < from.mNumVertices; ++i) {
            const aiVector3D& n = from.mNormals[i];
            const dvec3 normal(n.x, n.y, n.z);
            const double length = finite(n) ? glm::length(normal) : 0;
            out.normals.emplace_back(length > 0 ? normal / length : dvec3(0));
        }
        for (unsigned i = 0; from.HasTextureCoords(0) && i < from.mNumVertices; ++i) {
            const aiVector3D& t = from.mTextureCoords[0][i];
            out.uvs.emplace_back(finite(t) ? glm::vec2(t.x, t.y) : glm::vec2(0));
        }
        for (unsigned i = 0; from.HasVertexColors(0) && i < from.mNumVertices; ++i) {
            const aiColor4D& c = from.mColors[0][i];
            glm::vec3 colour(c.r, c.g, c.b);
            for (int k = 0; k < 3; ++k) {
                colour[k] = std::isfinite(colour[k]) ? std::clamp(colour[k], 0.0F, 1.0F) : 0.0F;
                // A scanner's bytes are what a screen showed; an OBJ's numbers are like those of Kd.
                if (is_ply_) colour[k] = linear_from_srgb(colour[k]);
            }
            out.colours.push_back(colour);
        }
    }

    void add_face(const aiFace& face, const std::vector<bool>& usable, Mesh& out) {
        if (face.mNumIndices < 3) return notes_.add("points and lines are left out");
        if (face.mNumIndices > largest_polygon) {
            fail(ExitCode::invalid_input, "{}: a polygon has too many corners (got {}; expected at most {})",
                 path_.string(), face.mNumIndices, largest_polygon);
        }
        corners_.clear();
        for (unsigned i = 0; i < face.mNumIndices; ++i) {
            const unsigned index = face.mIndices[i];
            if (index >= out.positions.size()) {
                fail(ExitCode::invalid_input,
                     "{}: a face refers to no vertex (got {}; expected less than {})", path_.string(), index,
                     out.positions.size());
            }
            if (!usable[index]) {
                return notes_.add("a face with a corner that is not finite, or beyond 1e12 m, is left out");
            }
            corners_.emplace_back(out.positions[index]);
        }
        const Triangulation cut = triangulate(corners_);
        if (cut.fault == PolygonFault::no_area) return notes_.add("a face without area is left out");
        if (cut.fault == PolygonFault::crosses_itself) {
            return notes_.add("a polygon that crosses itself is left out");
        }
        for (const glm::uvec3& t : cut.triangles) {
            out.triangles.emplace_back(face.mIndices[t.x], face.mIndices[t.y], face.mIndices[t.z]);
        }
    }

    std::filesystem::path path_;
    double unit_;
    bool is_ply_ = false;
    Scene scene_;
    SceneNotes notes_;
    std::map<unsigned, std::size_t> materials_;
    std::vector<dvec3> corners_;
    std::uint32_t id_ = 0;
};

}  // namespace

Scene read_mesh_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    return MeshReader(path, options).read();
}

}  // namespace postlens
