#include "scene/gltf/gltf_materials.h"

#include <array>
#include <map>
#include <optional>
#include <tuple>

#include "records/motion/scene_limits.h"
#include "scene/gltf/image_bytes.h"
#include "scene/metallic_roughness.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr std::size_t clamp_to_edge = 33071, mirrored_repeat = 33648, nearest_filter = 9728;

// Extensions that are read. Others cause a note to the user.
constexpr std::array<std::string_view, 7> known_extensions{
    "KHR_materials_transmission", "KHR_materials_volume",
    "KHR_materials_ior",          "KHR_materials_emissive_strength",
    "KHR_materials_specular",     "KHR_materials_unlit",
    "KHR_texture_transform"};

dvec3 colour_of(const JsonPlace& place, const char* key, const dvec3& otherwise, double most) {
    const auto v = place.numbers(key, 3, 0, most);
    return v ? dvec3((*v)[0], (*v)[1], (*v)[2]) : otherwise;
}

class MaterialReader {
  public:
    MaterialReader(GltfDocument& document, SceneNotes& notes) : d_(document), notes_(notes) {}

    GltfMaterials read() {
        GltfMaterials out;
        for (const JsonPlace& m : d_.root().objects("materials")) {
            UvSource uv;
            Material material = read_one(m, uv);
            material.name = printable_name(m.text("name").value_or(""),
                                           fmt::format("material {}", out.materials.size() + 1));
            out.materials.push_back(std::move(material));
            out.uvs.push_back(uv);
        }
        return out;
    }

  private:
    Material read_one(const JsonPlace& m, UvSource& uv) {
        MetallicRoughness s;
        const auto pbr = m.object("pbrMetallicRoughness");
        std::optional<JsonPlace> base_picture;
        if (pbr) {
            if (const auto c = pbr->numbers("baseColorFactor", 4, 0, 1)) {
                s.base = dvec3((*c)[0], (*c)[1], (*c)[2]);
                s.alpha = (*c)[3];
            }
            s.metallic = pbr->number("metallicFactor", 0, 1).value_or(1);
            s.roughness = pbr->number("roughnessFactor", 0, 1).value_or(1);
            base_picture = pbr->object("baseColorTexture");
            if (const auto t = pbr->object("metallicRoughnessTexture")) {
                s.roughness *= mean_of(*t, 1);
                s.metallic *= mean_of(*t, 2);
            }
        }
        read_alpha(m, s);
        s.emission = colour_of(m, "emissiveFactor", dvec3(0), 1);
        read_extensions(m, s);
        leave_out(m);

        Material out = whitted_material(s);
        bool has_uv = false;
        if (base_picture) {
            out.colour_texture = picture(*base_picture, uv);
            has_uv = out.colour_texture != nullptr;
            if (has_uv && s.metallic > 0 && !s.unlit) {
                notes_.add(
                    "the picture of a metal's base colour tints its diffuse light, not its mirror image");
            }
        }
        if (s.unlit) {
            // An unlit material emits its base colour and ignores the emissive factor.
            out.emission_has_colour = true;
        } else if (const auto t = m.object("emissiveTexture")) {
            read_emissive_picture(*t, has_uv, out, uv);
        }
        return out;
    }

    // Reads the emissive texture. A Material has only one set of texture coordinates, `uv`. If `has_uv` is
    // true, the base colour texture already determines `uv`. If the emissive texture needs other coordinates,
    // it cannot be stored, so it is replaced by its mean colour.
    void read_emissive_picture(const JsonPlace& info, bool has_uv, Material& out, UvSource& uv) {
        const RawImage* raw = image_of(info);
        const UvSource own = uv_source(info);
        if (!raw) {
            // The texture that multiplies this emission cannot be used. Without it, the whole surface would
            // emit light. But most of an emissive texture is usually black, so it is better if the surface
            // emits nothing.
            out.emission = dvec3(0);
            notes_.add("a surface whose emissiveTexture is left out emits nothing");
        } else if (has_uv && !(own == uv)) {
            out.emission *= mean_colour(*raw);
            notes_.add(
                "an emissiveTexture lies otherwise on the mesh than the baseColorTexture: the mean of it "
                "counts");
        } else {
            out.emission_texture = picture(info, uv);
        }
    }

    void read_alpha(const JsonPlace& m, MetallicRoughness& s) {
        const std::string mode = m.text("alphaMode").value_or("OPAQUE");
        if (mode == "MASK") {
            s.alpha = s.alpha < m.number("alphaCutoff", 0, 1e6).value_or(0.5) ? 0 : 1;
        } else if (mode != "BLEND") {
            s.alpha = 1;
        }
        wants_alpha_ = mode != "OPAQUE";
    }

    void read_extensions(const JsonPlace& m, MetallicRoughness& s) {
        if (const auto e = m.extension("KHR_materials_ior")) {
            s.ior = e->number("ior", 0, 100).value_or(1.5);
            // In glTF, an index of refraction of 0 means a mirror at all angles. This is not supported, nor
            // are other values below 1.
            if (s.ior < 1) {
                notes_.add("an index of refraction below 1 is taken as 1.5");
                s.ior = 1.5;
            }
        }
        if (const auto e = m.extension("KHR_materials_emissive_strength")) {
            s.emission *= e->number("emissiveStrength", 0, largest_colour).value_or(1);
        }
        if (const auto e = m.extension("KHR_materials_transmission")) {
            s.transmission = e->number("transmissionFactor", 0, 1).value_or(0);
            if (const auto t = e->object("transmissionTexture")) s.transmission *= mean_of(*t, 0);
        }
        if (const auto e = m.extension("KHR_materials_volume")) {
            s.solid = e->number("thicknessFactor", 0, largest_length_m).value_or(0) > 0;
            if (s.solid && e->has("attenuationDistance")) {
                notes_.add("the colour that a body of glass takes on with its thickness is left out");
            }
        }
        if (const auto e = m.extension("KHR_materials_specular")) {
            s.specular = e->number("specularFactor", 0, 1).value_or(1);
            s.specular_colour = colour_of(*e, "specularColorFactor", dvec3(1), largest_colour);
            if (e->has("specularTexture") || e->has("specularColorTexture")) {
                notes_.add("a texture of KHR_materials_specular is left out");
            }
        }
        s.unlit = m.extension("KHR_materials_unlit").has_value();
        if (const auto all = m.object("extensions")) {
            for (const auto& [name, value] : all->value().items()) {
                if (std::find(known_extensions.begin(), known_extensions.end(), name) ==
                    known_extensions.end()) {
                    notes_.add(fmt::format("the extension {} of a material is left out",
                                           printable_name(name, "''")));
                }
            }
        }
    }

    void leave_out(const JsonPlace& m) {
        if (m.has("normalTexture")) notes_.add("a normalTexture is left out");
        if (m.has("occlusionTexture")) notes_.add("an occlusionTexture is left out");
    }

    // Returns the decoded image of the texture that `info` refers to. If the texture has no image of a
    // supported kind, adds a note for the user and returns null.
    const RawImage* image_of(const JsonPlace& info) {
        const std::size_t texture = info.required(info.index("index", d_.count("textures")), "index");
        const JsonPlace t = d_.item("textures", texture);
        const auto source = t.index("source", d_.count("images"));
        if (!source) {
            notes_.add("a texture without a picture of a known kind is left out");
            return nullptr;
        }
        const auto [at, is_new] = images_.try_emplace(*source);
        if (is_new) at->second = decode(*source);
        return at->second ? &*at->second : nullptr;
    }

    std::optional<RawImage> decode(std::size_t index) {
        const JsonPlace image = d_.item("images", index);
        const auto view = image.index("bufferView", d_.count("bufferViews"));
        const auto uri = image.text("uri");
        if (!view && !uri) image.fail_here("has neither 'uri' nor 'bufferView' (expected one)");
        RawImage raw = decode_image(view ? d_.view(*view) : d_.resolve(*uri, image),
                                    fmt::format("{}: {}", d_.file, image.where()));
        pixels_ += static_cast<double>(raw.width) * raw.height;
        if (pixels_ > most_image_pixels) {
            image.fail_here("makes too much (expected at most {} px in all pictures)", most_image_pixels);
        }
        return raw;
    }

    double mean_of(const JsonPlace& info, std::size_t channel) {
        const RawImage* raw = image_of(info);
        if (!raw) return 1;
        const double mean = channel_mean(*raw, channel);
        notes_.add("of a texture for metallic, roughness or transmission the mean counts");
        return std::clamp(mean, 0.0, 1.0);
    }

    std::shared_ptr<const Texture> picture(const JsonPlace& info, UvSource& uv) {
        const RawImage* raw = image_of(info);
        uv = uv_source(info);
        if (!raw) return nullptr;
        if (wants_alpha_ && raw->has_alpha && channel_mean(*raw, 3) < 1) {
            notes_.add("the alpha of a picture is left out: the surface is there in all of it");
        }
        const JsonPlace t = d_.item("textures", *info.index("index", d_.count("textures")));
        const auto sampler = t.index("sampler", d_.count("samplers"));
        std::size_t wrap_s = 10497, wrap_t = 10497, filter = 9729;
        if (sampler) {
            const JsonPlace s = d_.item("samplers", *sampler);
            wrap_s = s.whole("wrapS", 0, 65535).value_or(wrap_s);
            wrap_t = s.whole("wrapT", 0, 65535).value_or(wrap_t);
            filter = s.whole("magFilter", 0, 65535).value_or(filter);
        }
        if (wrap_s == mirrored_repeat || wrap_t == mirrored_repeat) {
            notes_.add("a texture that is mirrored over its edges is repeated instead");
        }
        const std::size_t source = *t.index("source", d_.count("images"));
        const auto [at, is_new] = textures_.try_emplace(std::tuple(source, wrap_s, wrap_t, filter));
        if (is_new) {
            ImageTexture image = colour_image(*raw);
            image.clamp_u = wrap_s == clamp_to_edge;
            image.wrap_v = wrap_t != clamp_to_edge;
            image.nearest = filter == nearest_filter;
            at->second = std::make_shared<const Texture>(std::move(image));
        }
        return at->second;
    }

    UvSource uv_source(const JsonPlace& info) {
        constexpr double most = 1e9;
        UvSource uv;
        uv.set = info.whole("texCoord", 0, 15).value_or(0);
        if (const auto e = info.extension("KHR_texture_transform")) {
            uv.set = e->whole("texCoord", 0, 15).value_or(uv.set);
            if (const auto o = e->numbers("offset", 2, -most, most)) uv.offset = dvec2((*o)[0], (*o)[1]);
            if (const auto s = e->numbers("scale", 2, -most, most)) uv.scale = dvec2((*s)[0], (*s)[1]);
            uv.rotation = e->number("rotation", -most, most).value_or(0);
        }
        return uv;
    }

    GltfDocument& d_;
    SceneNotes& notes_;
    std::map<std::size_t, std::optional<RawImage>> images_;
    std::map<std::tuple<std::size_t, std::size_t, std::size_t, std::size_t>, std::shared_ptr<const Texture>>
        textures_;
    double pixels_ = 0;
    bool wants_alpha_ = false;
};

}  // namespace

GltfMaterials read_gltf_materials(GltfDocument& document, SceneNotes& notes) {
    return MaterialReader(document, notes).read();
}

}  // namespace postlens
