#include "scene/gltf/gltf_meshes.h"

#include <algorithm>
#include <cmath>

#include "records/motion/scene_limits.h"

namespace postlens {
namespace {

using glm::dvec3;

enum Mode : std::size_t { triangles = 4, strip = 5, fan = 6 };

// Returns the triangles of a list, a strip or a fan.
// Every second triangle of a strip is reversed, so that all have the same winding.
std::vector<glm::uvec3> assemble(std::size_t mode, const std::vector<std::uint32_t>& corners) {
    std::vector<glm::uvec3> out;
    if (mode == triangles) {
        out.reserve(corners.size() / 3);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
            out.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
        }
        return out;
    }
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        if (mode == fan) {
            out.emplace_back(corners[i + 1], corners[i + 2], corners[0]);
        } else {
            out.emplace_back(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]);
        }
    }
    return out;
}

class PrimitiveReader {
  public:
    PrimitiveReader(const GltfDocument& d, const JsonPlace& primitive, GltfAccessors& accessors,
                    SceneNotes& notes)
        : place_(primitive),
          attributes_(primitive.required(primitive.object("attributes"), "attributes")),
          count_(d.count("accessors")),
          accessors_(accessors),
          notes_(notes) {}

    [[nodiscard]] std::optional<GltfValues> attribute(const char* name,
                                                      std::initializer_list<std::size_t> components) {
        const auto index = attributes_.index(name, count_);
        if (!index) return std::nullopt;
        GltfValues values = accessors_.floats(*index, components, attributes_);
        if (!mesh_.positions.empty() && values.count != mesh_.positions.size()) {
            attributes_.fail_here("'{}' has the wrong length (got {}; expected one per position, {})", name,
                                  values.count, mesh_.positions.size());
        }
        return values;
    }

    Mesh read(std::size_t mode, double unit, const UvSource& uv) {
        read_positions(unit);
        read_triangles(mode);
        read_normals();
        read_uvs(uv);
        read_colours();
        return std::move(mesh_);
    }

  private:
    void read_positions(double unit) {
        const GltfValues p = attributes_.required(attribute("POSITION", {3}), "POSITION");
        mesh_.positions.reserve(p.count);
        for (std::size_t i = 0; i < p.count; ++i) {
            const dvec3 at = unit * dvec3(p.values[3 * i], p.values[3 * i + 1], p.values[3 * i + 2]);
            if (!(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) <= largest_length_m)) {
                attributes_.fail_here(
                    "has a position out of range (got ({}, {}, {}) m; expected at most {} m)", at.x, at.y,
                    at.z, largest_length_m);
            }
            mesh_.positions.emplace_back(at);
        }
    }

    void read_triangles(std::size_t mode) {
        std::vector<std::uint32_t> corners;
        if (const auto index = place_.index("indices", count_)) {
            corners = accessors_.indices(*index, mesh_.positions.size(), place_);
        } else {
            corners.resize(mesh_.positions.size());
            for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
        }
        if (mode == triangles && corners.size() % 3 != 0) {
            place_.fail_here("has corners left over (got {}; expected a multiple of 3)", corners.size());
        }
        mesh_.triangles = assemble(mode, corners);
        const auto kept =
            std::remove_if(mesh_.triangles.begin(), mesh_.triangles.end(), [&](const glm::uvec3& t) {
                const dvec3 a(mesh_.positions[t.x]), b(mesh_.positions[t.y]), c(mesh_.positions[t.z]);
                return glm::cross(b - a, c - a) == dvec3(0);
            });
        const auto dropped = mesh_.triangles.end() - kept;
        mesh_.triangles.erase(kept, mesh_.triangles.end());
        // In a triangle strip, triangles without area are normal, because they join pieces of a mesh.
        // Therefore, no note tells the user that they are left out.
        if (mode != strip) {
            for (auto i = dropped; i > 0; --i) notes_.add("a triangle without area is left out");
        }
    }

    void read_normals() {
        const auto n = attribute("NORMAL", {3});
        if (!n) return;
        mesh_.normals.reserve(n->count);
        for (std::size_t i = 0; i < n->count; ++i) {
            const dvec3 v(n->values[3 * i], n->values[3 * i + 1], n->values[3 * i + 2]);
            const double length = glm::length(v);
            mesh_.normals.emplace_back(length > 0 ? v / length : dvec3(0));
        }
    }

    void read_uvs(const UvSource& source) {
        const auto t = attribute(fmt::format("TEXCOORD_{}", source.set).c_str(), {2});
        if (!t) return;
        const double c = std::cos(source.rotation), s = std::sin(source.rotation);
        mesh_.uvs.reserve(t->count);
        for (std::size_t i = 0; i < t->count; ++i) {
            const double u = source.scale.x * t->values[2 * i], v = source.scale.y * t->values[2 * i + 1];
            // Applies the glTF extension KHR_texture_transform to the texture coordinates (u, v). It scales
            // them, then rotates them, and then adds an offset. The rotation is counter-clockwise on the
            // image, where v points down. In the mesh, v points up, so the resulting v is subtracted from 1.
            mesh_.uvs.emplace_back(c * u + s * v + source.offset.x, 1 - (-s * u + c * v + source.offset.y));
        }
    }

    void read_colours() {
        const auto k = attribute("COLOR_0", {3, 4});
        if (!k) return;
        mesh_.colours.reserve(k->count);
        for (std::size_t i = 0; i < k->count; ++i) {
            const float* at = k->values.data() + i * k->components;
            mesh_.colours.emplace_back(glm::clamp(glm::vec3(at[0], at[1], at[2]), 0.0F, 1.0F));
        }
    }

    JsonPlace place_, attributes_;
    std::size_t count_;
    GltfAccessors& accessors_;
    SceneNotes& notes_;
    Mesh mesh_;
};

}  // namespace

std::vector<GltfPart> read_gltf_mesh(const GltfDocument& document, std::size_t index,
                                     GltfAccessors& accessors, const std::vector<UvSource>& uvs,
                                     double metres_per_unit, SceneNotes& notes) {
    const JsonPlace mesh = document.item("meshes", index);
    if (!mesh.has("primitives")) mesh.fail_here("has no 'primitives' (expected at least one)");
    std::vector<GltfPart> parts;
    for (const JsonPlace& p : mesh.objects("primitives")) {
        const std::size_t mode = p.whole("mode", 0, 6).value_or(triangles);
        if (mode < triangles) {
            notes.add("points and lines are left out");
            continue;
        }
        if (p.has("targets")) notes.add("morph targets are left out: the mesh has its own shape");
        if (p.extension("KHR_materials_variants")) notes.add("variants of materials are left out");
        GltfPart part;
        part.material = p.index("material", uvs.size());
        PrimitiveReader reader(document, p, accessors, notes);
        Mesh read = reader.read(mode, metres_per_unit, part.material ? uvs[*part.material] : UvSource{});
        if (read.triangles.empty()) continue;
        part.mesh = std::make_shared<const Mesh>(std::move(read));
        parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace postlens
