#include "scene/toml/toml_objects.h"

#include <array>
#include <cmath>
#include <map>

#include "core/text.h"
#include "records/motion/toml_transform.h"
#include "scene/toml/toml_materials.h"
#include "scene/toml/toml_shapes.h"

namespace postlens {
namespace {

using glm::dmat4;
using glm::dvec3;
using Name = std::string_view;

constexpr std::array<Name, 7> common_keys{"name",          "shape", "material", "hidden",
                                          "casts_shadows", "keys",  "repeat"};

// A shape of an object, which instances of the object copy.
struct Part {
    Shape shape;
    std::size_t material = 0;
    bool casts_shadows = true;
    dmat4 placement{1};  // world_from_object at rest
};

// The content of a named object. Instances of the object copy it.
struct Template {
    std::vector<Part> parts;
    bool moves = false;
};

// One copy of a repeated object.
struct Copy {
    dvec3 shift{0};
    std::string suffix;  // appended to the object's name
};

dmat4 shifted(const dvec3& by, const dmat4& m) {
    dmat4 out = m;
    out[3] += glm::dvec4(by, 0);
    return out;
}

class ObjectReader {
  public:
    ObjectReader(double unit, Scene& scene) : unit_(unit), scene_(scene) {}

    void read(TomlTable& t) {
        ++number_;
        if (!t.has("shape")) refuse_unknown_of_any_shape(t);
        const std::size_t kind = t.required(t.choice("shape", shape_kinds), "shape");
        const auto given_name = t.text("name");
        const std::string name = given_name.value_or(fmt::format("{} {}", shape_kinds[kind], number_));
        t.rename(fmt::format("object '{}'", name));
        t.allow_only({common_keys, transform_keys, shape_keys(kind)});
        if (given_name && templates_.contains(*given_name)) {
            t.fail_at("name", "two objects have the name {}", excerpt(name));
        }
        const std::vector<Part> parts = kind == instance_kind ? instance_parts(t) : shape_parts(t, kind);
        const dmat4 placement = read_transform(t, unit_);
        const std::vector<TransformKey> keys = read_motion(t, unit_, false);
        const std::vector<Copy> copies = read_copies(t);
        const bool hidden = t.flag("hidden").value_or(false);
        if (hidden && !given_name) t.fail_at("hidden", "a hidden object without a name can never be seen");
        shape_count_ += parts.size() * copies.size();
        if (shape_count_ > largest_shape_count) {
            t.fail_here("the scene has too many shapes (got {}; expected at most {})", shape_count_,
                        largest_shape_count);
        }
        if (!hidden) add_objects(name, parts, placement, keys, copies);
        if (given_name) add_template(*given_name, parts, placement, keys, copies);
    }

  private:
    // Checks the keys of an object's table `t` if its key "shape" is missing or misspelt. Since the intended
    // shape is unknown, the keys of all shapes are accepted. Otherwise, a correct key would be reported
    // instead of the wrong "shape".
    static void refuse_unknown_of_any_shape(const TomlTable& t) {
        std::vector<Name> all;
        for (std::size_t kind = 0; kind < shape_kinds.size(); ++kind) {
            all.insert(all.end(), shape_keys(kind).begin(), shape_keys(kind).end());
        }
        t.allow_only({common_keys, transform_keys, all});
    }

    std::optional<std::size_t> read_material(const TomlTable& t) const {
        const auto name = t.text("material");
        if (!name) return std::nullopt;
        std::vector<Name> known;
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
            if (scene_.materials[i].name == *name) return i;
            known.push_back(scene_.materials[i].name);
        }
        t.fail_at("material", "{}", unknown_name("material", *name, known));
    }

    std::size_t default_material() {
        if (!default_material_) {
            default_material_ = scene_.materials.size();
            scene_.materials.emplace_back().name = "default";
        }
        return *default_material_;
    }

    std::vector<Part> shape_parts(const TomlTable& t, std::size_t kind) {
        Part part;
        part.shape = read_shape(t, kind, unit_);
        const auto material = read_material(t);
        part.material = material ? *material : default_material();
        part.casts_shadows = t.flag("casts_shadows").value_or(true);
        return {part};
    }

    std::vector<Part> instance_parts(const TomlTable& t) const {
        std::vector<Part> parts;
        const auto material = read_material(t);
        const auto casts_shadows = t.flag("casts_shadows");
        for (const std::string& name : t.required(t.texts("of"), "of")) {
            const Template& original = find_template(t, name);
            if (original.moves) {
                t.fail_at("of", "{} moves and cannot be instanced (expected 'keys' on the instance instead)",
                          excerpt(name));
            }
            for (Part part : original.parts) {
                part.material = material.value_or(part.material);
                part.casts_shadows = casts_shadows.value_or(part.casts_shadows);
                parts.push_back(std::move(part));
            }
            if (parts.size() > largest_shape_count) break;
        }
        if (parts.empty()) t.fail_at("of", "'of' names nothing (expected at least one object)");
        return parts;
    }

    const Template& find_template(const TomlTable& t, const std::string& name) const {
        const auto at = templates_.find(name);
        if (at != templates_.end()) return at->second;
        std::vector<Name> known;
        for (const auto& [other, value] : templates_) known.push_back(other);
        t.fail_at("of", "{}; an instance stands below what it repeats",
                  unknown_name("object above", name, known));
    }

    std::vector<Copy> read_copies(const TomlTable& t) const {
        const auto repeat = t.table("repeat");
        if (!repeat) return {Copy{}};
        static constexpr std::array<Name, 3> known{"count", "step_m", "at_m"};
        repeat->allow_only({known});
        repeat->refuse_both("count", "at_m");
        repeat->refuse_both("step_m", "at_m");
        std::vector<Copy> copies;
        if (const auto places = repeat->rows("at_m", 3, 3, length_range(unit_))) {
            if (places->empty()) repeat->fail_at("at_m", "'at_m' is empty (expected at least one place)");
            for (const auto& p : *places) {
                copies.push_back({unit_ * dvec3(p[0], p[1], p[2]), fmt::format("[{}]", copies.size())});
            }
            return copies;
        }
        const dvec3 step = unit_ * repeat->required(repeat->vec3("step_m", length_range(unit_)), "step_m");
        if (repeat->has("count") && !repeat->is_array("count")) {
            const int count = *repeat->integer("count", 1, static_cast<int>(largest_shape_count));
            for (int i = 0; i < count; ++i)
                copies.push_back({step * static_cast<double>(i), fmt::format("[{}]", i)});
            return copies;
        }
        const auto count = repeat->required(repeat->numbers("count", 3, {.min = 1, .max = 1e6}), "count");
        const double total = count[0] * count[1] * count[2];
        if (total > static_cast<double>(largest_shape_count)) {
            repeat->fail_at("count", "'count' makes too many copies (got {:.0f}; expected at most {})", total,
                            largest_shape_count);
        }
        for (const double n : count) {
            if (n != std::floor(n))
                repeat->fail_at("count", "'count' is not whole (got {}; expected whole numbers)", n);
        }
        for (int k = 0; k < count[2]; ++k) {
            for (int j = 0; j < count[1]; ++j) {
                for (int i = 0; i < count[0]; ++i) {
                    copies.push_back({step * dvec3(i, j, k), fmt::format("[{},{},{}]", i, j, k)});
                }
            }
        }
        return copies;
    }

    void add_objects(const std::string& name, const std::vector<Part>& parts, const dmat4& placement,
                     const std::vector<TransformKey>& keys, const std::vector<Copy>& copies) {
        const dmat4 moved = transform_at(keys, scene_.time_s);
        for (const Copy& copy : copies) {
            ++id_;
            const dmat4 still = shifted(copy.shift, placement);
            for (const Part& part : parts) {
                Object object;
                object.name = name + copy.suffix;
                object.id = id_;
                object.material = part.material;
                object.shape = part.shape;
                object.motion_base = still * part.placement;
                object.world_from_object = keys.empty() ? object.motion_base : moved * object.motion_base;
                object.keys = keys;
                object.casts_shadows = part.casts_shadows;
                scene_.objects.push_back(std::move(object));
            }
        }
    }

    void add_template(const std::string& name, const std::vector<Part>& parts, const dmat4& placement,
                      const std::vector<TransformKey>& keys, const std::vector<Copy>& copies) {
        Template made;
        made.moves = !keys.empty();
        for (const Copy& copy : copies) {
            for (Part part : parts) {
                part.placement = shifted(copy.shift, placement) * part.placement;
                made.parts.push_back(std::move(part));
            }
        }
        templates_.emplace(name, std::move(made));
    }

    double unit_;
    Scene& scene_;
    std::map<std::string, Template, std::less<>> templates_;
    std::optional<std::size_t> default_material_;
    std::size_t number_ = 0, shape_count_ = 0;
    std::uint32_t id_ = 0;
};

}  // namespace

void read_objects(const TomlTable& root, double metres_per_unit, Scene& scene) {
    ObjectReader reader(metres_per_unit, scene);
    for (TomlTable& t : root.tables("object", "object")) reader.read(t);
}

}  // namespace postlens
