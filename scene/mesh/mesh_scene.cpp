#include "scene/mesh/mesh_scene.h"

#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/text.h"
#include "pictures/srgb.h"
#include "records/motion/scene_limits.h"
#include "scene/mesh/mesh_files.h"
#include "scene/mesh/mesh_materials.h"
#include "scene/mesh/obj_text.h"
#include "scene/mesh/ply_file.h"
#include "scene/scene_defaults.h"
#include "scene/toml/toml_objects.h"
#include "scene/triangulate.h"

namespace postlens {
namespace {

using glm::dvec2;
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
        is_ply_ = lower_case(path.extension().string()) == ".ply";
        scene_.name = path.stem().string();
        scene_.ambient_light = dvec3(mesh_ambient_light);
    }

    Scene read() {
        const std::string bytes = read_text_file(path_, largest_mesh_file_bytes);
        std::vector<ReferredFile> referred;
        is_ply_ ? add_ply(bytes, referred) : add_obj(bytes, referred);
        notes_.append_to(scene_.notes, path_);
        name_sources(bytes, referred, scene_);
        complete_scene(scene_, path_, answers_to_lights(scene_), 1, open_side(scene_));
        return std::move(scene_);
    }

  private:
    void add_obj(const std::string& bytes, std::vector<ReferredFile>& referred) {
        // Assimp's importer takes ownership of this object.
        auto* const files = new MeshFiles(path_, rewritten_obj(as_utf8(bytes)), notes_);
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
        referred = files->opened();
        MeshMaterials materials(path_, referred, notes_);
        pictures_ = files->pictures();
        add_node(*found, *found->mRootNode, materials);
    }

    void add_ply(const std::string& bytes, std::vector<ReferredFile>& referred) {
        const PlyFile from = read_ply_file(bytes, path_.string(), notes_);
        if (from.corner_counts.empty()) {
            fail(ExitCode::invalid_input,
                 "{}: has no faces (got {} points; expected triangles, polygons or strips)", path_.string(),
                 from.positions.size());
        }
        Object object;
        object.name = printable_name(scene_.name, "mesh");
        object.id = 1;
        object.shape = std::make_shared<const Mesh>(ply_mesh(from));
        Material material = MeshMaterials::plain();
        if (!from.texture_file.empty()) {
            material.colour_texture = MeshMaterials(path_, referred, notes_).picture(from.texture_file);
        }
        scene_.materials.push_back(std::move(material));
        if (!std::get<std::shared_ptr<const Mesh>>(object.shape)->triangles.empty())
            scene_.objects.push_back(std::move(object));
    }

    Mesh ply_mesh(const PlyFile& from) {
        Mesh out;
        std::vector<bool> usable;
        // If texture coordinates are given per corner of a face, each corner becomes a separate vertex.
        const bool is_unrolled = !from.corner_uvs.empty();
        const std::size_t count = is_unrolled ? from.corners.size() : from.positions.size();
        std::vector<unsigned> face;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t at = is_unrolled ? checked(from.corners[i], from.positions.size()) : i;
            add_position(from.positions[at], usable, out);
            if (!from.normals.empty()) out.normals.emplace_back(unit_normal(from.normals[at]));
            if (!from.colours.empty()) out.colours.push_back(screen_colour(from.colours[at]));
            const auto& uvs = is_unrolled ? from.corner_uvs : from.uvs;
            if (!uvs.empty()) out.uvs.push_back(i < uvs.size() ? finite_uv(uvs[i]) : glm::vec2(0));
        }
        std::uint32_t first = 0;
        for (const std::uint32_t corners : from.corner_counts) {
            face.clear();
            for (std::uint32_t i = first; i < first + corners; ++i)
                face.push_back(is_unrolled ? i : from.corners[i]);
            add_face(face, usable, out);
            first += corners;
        }
        return out;
    }

    [[nodiscard]] std::size_t checked(std::size_t index, std::size_t count) const {
        if (index >= count) {
            fail(ExitCode::invalid_input, "{}: a face refers to no vertex (got {}; expected less than {})",
                 path_.string(), index, count);
        }
        return index;
    }

    void add_position(const dvec3& in_file, std::vector<bool>& usable, Mesh& out) const {
        const dvec3 p = unit_ * in_file;
        usable.push_back(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= largest_length_m &&
                         p == p);
        out.positions.emplace_back(usable.back() ? p : dvec3(0));
    }

    static dvec3 unit_normal(const dvec3& normal) {
        const bool is_finite = std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z);
        const double length = is_finite ? glm::length(normal) : 0;
        return length > 0 && std::isfinite(length) ? normal / length : dvec3(0);
    }

    static glm::vec2 finite_uv(const glm::dvec2& uv) {
        const glm::vec2 out(uv);
        return std::isfinite(out.x) && std::isfinite(out.y) ? out : glm::vec2(0);
    }

    static glm::vec3 bounded_colour(glm::vec3 colour) {
        for (int k = 0; k < 3; ++k)
            colour[k] = std::isfinite(colour[k]) ? std::clamp(colour[k], 0.0F, 1.0F) : 0.0F;
        return colour;
    }

    // Colours in PLY files are treated as sRGB, because scanners write sRGB.
    // Those in OBJ files are linear, like Kd.
    static glm::vec3 screen_colour(const glm::vec3& colour) {
        glm::vec3 out = bounded_colour(colour);
        for (int k = 0; k < 3; ++k) out[k] = linear_from_srgb(out[k]);
        return out;
    }

    const aiScene* import(Assimp::Importer& importer) const {
        std::string why;
        try {
            if (const aiScene* found = importer.ReadFile(path_.string(), 0); found && found->mRootNode)
                return found;
            why = importer.GetErrorString();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& e) {  // assimp catches most, but not all, of its own exceptions
            why = e.what();
        }
        fail(ExitCode::invalid_input, "{}: cannot read ({})", path_.string(), one_line(why));
    }

    // Node trees of OBJ files have only two levels, so the recursion is not deep.
    void add_node(const aiScene& from, const aiNode& node, MeshMaterials& materials) {
        if (node.mNumMeshes > 0) {
            const std::string name = node.mName.C_Str();
            const bool is_nameless = name.empty() || name == "defaultobject";
            const std::size_t before = scene_.objects.size();
            for (unsigned i = 0; i < node.mNumMeshes; ++i) {
                const aiMesh& mesh = *from.mMeshes[node.mMeshes[i]];
                Mesh read = read_mesh(mesh, uv_options(*from.mMaterials[mesh.mMaterialIndex]));
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

    MaterialPictures pictures_of(const aiMaterial& material) const {
        const auto found = pictures_.find(material.GetName().C_Str());
        return found == pictures_.end() ? MaterialPictures{} : found->second;
    }

    // Returns how textures are mapped to the surface: like the diffuse texture, or else like the emissive
    // one.
    PictureOptions uv_options(const aiMaterial& material) const {
        const MaterialPictures pictures = pictures_of(material);
        return material.GetTextureCount(aiTextureType_DIFFUSE) > 0 ? pictures.colour : pictures.emission;
    }

    std::size_t material_of(const aiScene& from, unsigned index, MeshMaterials& materials) {
        const auto [at, is_new] = materials_.try_emplace(index, scene_.materials.size());
        if (is_new) {
            const aiMaterial& m = *from.mMaterials[index];
            const bool is_made = std::string_view(m.GetName().C_Str()) == AI_DEFAULT_MATERIAL_NAME;
            scene_.materials.push_back(is_made ? MeshMaterials::plain() : materials.read(m, pictures_of(m)));
        }
        return at->second;
    }

    Mesh read_mesh(const aiMesh& from, const PictureOptions& picture) {
        Mesh out;
        std::vector<bool> usable;
        for (unsigned i = 0; i < from.mNumVertices; ++i) {
            const aiVector3D& v = from.mVertices[i];
            add_position({v.x, v.y, v.z}, usable, out);
            if (from.HasNormals()) {
                const aiVector3D& n = from.mNormals[i];
                out.normals.emplace_back(unit_normal({n.x, n.y, n.z}));
            }
            if (from.HasTextureCoords(0)) {
                const aiVector3D& t = from.mTextureCoords[0][i];
                out.uvs.push_back(finite_uv(picture.scale * dvec2(t.x, t.y) + picture.offset));
            }
            if (from.HasVertexColors(0)) {
                const aiColor4D& c = from.mColors[0][i];
                out.colours.push_back(bounded_colour({c.r, c.g, c.b}));
            }
        }
        for (unsigned i = 0; i < from.mNumFaces; ++i) {
            const aiFace& face = from.mFaces[i];
            add_face({face.mIndices, face.mNumIndices}, usable, out);
        }
        return out;
    }

    void add_face(std::span<const unsigned> face, const std::vector<bool>& usable, Mesh& out) {
        if (face.size() < 3) return notes_.add("points and lines are left out");
        if (face.size() > largest_polygon) {
            fail(ExitCode::invalid_input, "{}: a polygon has too many corners (got {}; expected at most {})",
                 path_.string(), face.size(), largest_polygon);
        }
        corners_.clear();
        for (const unsigned index : face) {
            if (!usable[checked(index, out.positions.size())]) {
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
            out.triangles.emplace_back(face[t.x], face[t.y], face[t.z]);
        }
    }

    std::filesystem::path path_;
    double unit_;
    bool is_ply_ = false;
    Scene scene_;
    SceneNotes notes_;
    std::map<unsigned, std::size_t> materials_;
    std::map<std::string, MaterialPictures> pictures_;  ///< texture options of an OBJ's materials
    std::vector<dvec3> corners_;
    std::uint32_t id_ = 0;
};

}  // namespace

Scene read_mesh_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    return MeshReader(path, options).read();
}

}  // namespace postlens
