#include "scene/gltf/gltf_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "scene/gltf/gltf_materials.h"
#include "scene/gltf/gltf_meshes.h"
#include "scene/gltf/gltf_nodes.h"
#include "scene/gltf/gltf_views.h"
#include "scene/sampled_motion.h"
#include "scene/scene_defaults.h"
#include "scene/shape_bounds.h"
#include "scene/toml/toml_objects.h"

namespace postlens {
namespace {

using glm::dmat4;
using glm::dvec3;

// Largest error of a motion approximated by keyframes, as a fraction of the size of the moving objects.
constexpr double motion_tolerance = 1e-4;

class GltfReader {
  public:
    GltfReader(const std::filesystem::path& path, const SceneReadOptions& options)
        : options_(options), unit_(options.metres_per_unit) {
        read_gltf_document(path, d_);
        scene_.name = path.stem().string();
    }

    Scene read() {
        GltfMaterials materials = read_gltf_materials(d_, notes_);
        scene_.materials = std::move(materials.materials);
        uvs_ = std::move(materials.uvs);
        const GltfNodes nodes(d_, read_gltf_animations(d_, accessors_, unit_, notes_), unit_, notes_);
        for (const GltfNode& node : nodes.nodes()) add_objects(node);
        move_objects(nodes);
        add_views(nodes);
        notes_.append_to(scene_.notes, d_.path);
        name_sources(d_.bytes.front(), d_.files, scene_);
        // A file with lights gets no default ambient light.
        if (!scene_.lights.empty()) scene_.ambient_light = dvec3(0);
        complete_scene(scene_, d_.path, answers_to_lights(scene_), 1, open_side(scene_));
        return std::move(scene_);
    }

  private:
    const std::vector<GltfPart>& parts_of(std::size_t mesh) {
        const auto [at, is_new] = meshes_.try_emplace(mesh);
        if (is_new) at->second = read_gltf_mesh(d_, mesh, accessors_, uvs_, unit_, notes_);
        return at->second;
    }

    std::size_t material_of(const GltfPart& part) {
        if (part.material) return *part.material;
        if (!default_material_) {
            default_material_ = scene_.materials.size();
            // The default material is white and diffuse. glTF defines it as a rough white metal, which
            // authors rarely intend.
            scene_.materials.emplace_back().name = "default";
        }
        return *default_material_;
    }

    void add_objects(const GltfNode& node) {
        const JsonPlace place = d_.item("nodes", node.index);
        if (place.has("skin")) notes_.add("a skin is left out: its mesh stands as it was made");
        if (place.extension("EXT_mesh_gpu_instancing")) {
            notes_.add("EXT_mesh_gpu_instancing is left out: the mesh is shown once");
        }
        const auto mesh = place.index("mesh", d_.count("meshes"));
        if (!mesh) return;
        const std::string name =
            printable_name(place.text("name").value_or(""),
                           printable_name(d_.item("meshes", *mesh).text("name").value_or(""),
                                          fmt::format("node {}", node.index)));
        const dmat4 rest = node.frame ? node.frame_from_node : node.world_from_node;
        bool first = true;
        for (const GltfPart& part : parts_of(*mesh)) {
            const glm::dmat3 linear(rest);
            const double volume = glm::determinant(linear);
            if (!(std::abs(volume) >
                  1e-12 * glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]))) {
                notes_.add("a node that flattens its mesh is left out");
                continue;
            }
            if (first) ++id_;
            first = false;
            Object object;
            object.name = name;
            object.id = id_;
            object.material = material_of(part);
            object.shape = part.mesh;
            object.world_from_object = object.motion_base = rest;
            if (node.frame) moving_[*node.frame].push_back(scene_.objects.size());
            scene_.objects.push_back(std::move(object));
            if (scene_.objects.size() > largest_shape_count) {
                place.fail_here("makes too many shapes (expected at most {} in the scene)",
                                largest_shape_count);
            }
        }
    }

    void move_objects(const GltfNodes& nodes) {
        for (const auto& [moving_frame, objects] : moving_) {
            const auto frame = moving_frame;  // clang 14 cannot capture a structured binding in a lambda
            Bounds box;
            for (const std::size_t i : objects) {
                box.add(shape_bounds(scene_.objects[i].shape, scene_.objects[i].motion_base));
            }
            std::vector<dvec3> corners;
            for (int c = 0; c < 8; ++c) {
                corners.emplace_back(c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y,
                                     c & 4 ? box.max.z : box.min.z);
            }
            const auto times = nodes.frame_times_s(frame);
            double scale = 0;
            for (const double t : times) {
                const dvec3 s = glm::abs(nodes.frame_at(frame, t).scale);
                scale = std::max({scale, s.x, s.y, s.z});
            }
            const double size = scale * glm::length(box.max - box.min);
            if (nodes.frame_shear(frame) > 1e-3) {
                notes_.add("a motion shears what it moves; its nearest turn and scale stand for it");
            }
            const std::vector<TransformKey> keys =
                keys_of([&](double t) { return nodes.frame_at(frame, t); }, times, corners, size);
            for (const std::size_t i : objects) {
                Object& o = scene_.objects[i];
                o.world_from_object = transform_at(keys, scene_.time_s) * o.motion_base;
                if (moves(keys)) o.keys = keys;
            }
        }
    }

    static bool moves(const std::vector<TransformKey>& keys) {
        return std::any_of(keys.begin(), keys.end(), [&](const TransformKey& k) {
            return k.translation != keys.front().translation || k.rotation != keys.front().rotation ||
                   k.scale != keys.front().scale;
        });
    }

    std::vector<TransformKey> keys_of(const std::function<Placement(double)>& at,
                                      const std::vector<double>& times, std::span<const dvec3> points,
                                      double size_m) {
        SampledMotion motion = sampled_motion(at, times, points, motion_tolerance * size_m);
        if (motion.error_m > 2 * motion_tolerance * size_m) {
            notes_.add("a motion is followed less closely than to 1/10000 of the size of what moves");
        }
        return std::move(motion.keys);
    }

    void add_views(const GltfNodes& nodes) {
        Bounds all;
        for (const Object& o : scene_.objects) all.add(shape_bounds(o.shape, o.world_from_object));
        const double size = all.empty() ? 1 : std::max(glm::length(all.max - all.min), 1e-6);
        const std::vector<dvec3> points{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
        for (const GltfNode& node : nodes.nodes()) {
            const JsonPlace place = d_.item("nodes", node.index);
            dmat4 world = node.world_from_node;
            std::vector<TransformKey> keys;
            const auto camera = gltf_camera(d_, place, unit_);
            const auto light = gltf_light(d_, place, options_, notes_);
            if (light) scene_.lumens_per_watt = options_.lumens_per_watt;
            if (!camera && !light) continue;
            if (node.frame) {
                const Placement within = decompose(node.frame_from_node).placement;
                const auto rigid = [&](double t) {
                    Placement p = compose(nodes.frame_at(*node.frame, t), within).placement;
                    p.scale = dvec3(1);
                    return p;
                };
                keys = keys_of(rigid, nodes.frame_times_s(*node.frame), points, size);
                if (!moves(keys)) {
                    world = transform_at(keys, 0);
                    keys.clear();
                }
            }
            if (!keys.empty()) world = dmat4(1);  // the keyframes contain the whole placement
            if (camera) add_camera(*camera, world, keys);
            if (light) add_light(*light, world, keys);
        }
    }

    void add_camera(Camera camera, const dmat4& world, const std::vector<TransformKey>& keys) {
        const Placement p = decompose(world).placement;
        camera.position = p.translation;
        camera.look_at = p.translation + p.rotation * dvec3(0, 0, -1);
        camera.up = p.rotation * dvec3(0, 1, 0);
        camera.keys = keys;
        camera.name = unused_name(camera.name);
        scene_.cameras.push_back(std::move(camera));
    }

    void add_light(Light light, const dmat4& world, const std::vector<TransformKey>& keys) {
        const Placement p = decompose(world).placement;
        light.position = p.translation;
        light.direction = p.rotation * dvec3(0, 0, -1);
        light.keys = keys;
        scene_.lights.push_back(std::move(light));
    }

    // Makes a camera's name unique, because --camera selects a camera by its name.
    [[nodiscard]] std::string unused_name(const std::string& name) const {
        std::string out = name;
        for (int n = 2; std::any_of(scene_.cameras.begin(), scene_.cameras.end(),
                                    [&](const Camera& c) { return c.name == out; });
             ++n) {
            out = fmt::format("{} ({})", name, n);
        }
        return out;
    }

    SceneReadOptions options_;
    double unit_;
    GltfDocument d_;
    SceneNotes notes_;
    GltfAccessors accessors_{d_};
    Scene scene_;
    std::vector<UvSource> uvs_;
    std::map<std::size_t, std::vector<GltfPart>> meshes_;
    std::optional<std::size_t> default_material_;
    std::map<std::size_t, std::vector<std::size_t>> moving_;  // frame -> objects
    std::uint32_t id_ = 0;
};

}  // namespace

Scene read_gltf_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    return GltfReader(path, options).read();
}

}  // namespace postlens
