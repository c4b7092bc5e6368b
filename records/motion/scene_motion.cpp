#include "records/motion/scene_motion.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace postlens {
namespace {

using nlohmann::json;

json json_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

json json_of(const std::vector<TransformKey>& keys) {
    json out = json::array();
    for (const TransformKey& k : keys) {
        out.push_back({{"time_s", k.time_s},
                       {"translation_m", json_of(k.translation)},
                       {"rotation_wxyz", {k.rotation.w, k.rotation.x, k.rotation.y, k.rotation.z}},
                       {"scale", json_of(k.scale)}});
    }
    return out;
}

/// Reads values from JSON, and reports all errors in the same form.
class Reader {
  public:
    explicit Reader(const std::string& source) : source_(source) {}

    [[noreturn]] void refuse(const char* what) const {
        fail(ExitCode::invalid_input, "{}: attribute postlens.motion is damaged ({})", source_, what);
    }
    [[nodiscard]] const json& member(const json& from, const char* name) const {
        if (!from.is_object() || !from.contains(name)) refuse(name);
        return from[name];
    }
    [[nodiscard]] double number(const json& from, const char* name) const {
        const json& value = member(from, name);
        if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(name);
        return value.get<double>();
    }
    template <int count>
    [[nodiscard]] glm::vec<count, double> vector(const json& from, const char* name) const {
        const json& value = member(from, name);
        if (!value.is_array() || value.size() != count) refuse(name);
        glm::vec<count, double> out;
        for (int i = 0; i < count; ++i) {
            const json& v = value[static_cast<std::size_t>(i)];
            if (!v.is_number() || !std::isfinite(v.get<double>())) refuse(name);
            out[i] = v.get<double>();
        }
        return out;
    }
    [[nodiscard]] std::vector<TransformKey> keys(const json& from) const {
        if (!from.is_array()) refuse("keys");
        std::vector<TransformKey> out;
        for (const json& k : from) {
            const auto r = vector<4>(k, "rotation_wxyz");
            const TransformKey key{number(k, "time_s"), vector<3>(k, "translation_m"),
                                   glm::dquat(r[0], r[1], r[2], r[3]), vector<3>(k, "scale")};
            if (!out.empty() && !(key.time_s > out.back().time_s)) refuse("times do not grow");
            if (std::abs(glm::dot(r, r) - 1) > 1e-6) refuse("rotation_wxyz");
            if (key.scale.x == 0 || key.scale.y == 0 || key.scale.z == 0) refuse("scale");
            out.push_back(key);
        }
        return out;
    }

  private:
    const std::string& source_;
};

ObjectMotion object_of(const json& from, const Reader& read) {
    ObjectMotion out{read.keys(read.member(from, "keys")), read.vector<3>(from, "centre_m"),
                     read.number(from, "radius_m")};
    if (out.keys.empty()) read.refuse("keys");
    if (out.radius_m < 0) read.refuse("radius_m");
    return out;
}

LightMotion light_of(const json& from, const Reader& read) {
    LightMotion out;
    out.directional = from.is_object() && from.contains("direction");
    out.place = read.vector<3>(from, out.directional ? "direction" : "position_m");
    const json& shadows = read.member(from, "casts_shadows");
    if (!shadows.is_boolean()) read.refuse("casts_shadows");
    out.casts_shadows = shadows.get<bool>();
    out.keys = read.keys(read.member(from, "keys"));
    return out;
}

}  // namespace

std::string motion_text(const SceneMotion& motion) {
    if (motion.empty()) return {};
    json out = json::object();
    for (const auto& [id, object] : motion.objects) {
        out["objects"][std::to_string(id)] = {{"keys", json_of(object.keys)},
                                              {"centre_m", json_of(object.centre_m)},
                                              {"radius_m", object.radius_m}};
    }
    if (!motion.camera.empty()) out["camera"] = json_of(motion.camera);
    for (const LightMotion& light : motion.lights) {
        out["lights"].push_back({{light.directional ? "direction" : "position_m", json_of(light.place)},
                                 {"casts_shadows", light.casts_shadows},
                                 {"keys", json_of(light.keys)}});
    }
    return out.dump();
}

SceneMotion motion_of_text(const std::string& text, const std::string& source) {
    SceneMotion out;
    if (text.empty()) return out;
    const Reader read(source);
    const json from = json::parse(text, nullptr, false);
    if (!from.is_object()) read.refuse("not JSON");
    for (const auto& [name, value] : from.items()) {
        if (name == "camera") {
            out.camera = read.keys(value);
        } else if (name == "objects") {
            if (!value.is_object()) read.refuse("objects");
            for (const auto& [id_text, object] : value.items()) {
                std::uint32_t id = 0;
                const char* end = id_text.data() + id_text.size();
                const auto [stop, error] = std::from_chars(id_text.data(), end, id);
                if (error != std::errc() || stop != end || id == 0) read.refuse("an id");
                out.objects.emplace(id, object_of(object, read));
            }
        } else if (name == "lights") {
            if (!value.is_array()) read.refuse("lights");
            for (const json& light : value) out.lights.push_back(light_of(light, read));
        } else {
            read.refuse("an unknown key");
        }
    }
    return out;
}

}  // namespace postlens
