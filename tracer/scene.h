// The scene as the tracer sees it: metres, scene-linear colours, every default resolved. Readers make one of
// these (read_toml_scene, read_nff_scene); build_scene turns it into something rays can hit.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "records/transform_key.h"
#include "tracer/texture.h"

namespace postlens {

/// Whitted's model, every coefficient a colour:
/// I = emission + ambient Ia + sum over lights (diffuse N.L + diffuse_transmission (-N.L) + specular (R.V)^n)
///     + reflection R + transmission T.
struct Material {
    std::string name;
    glm::dvec3 ambient{0.1};
    glm::dvec3 diffuse{0.8};
    glm::dvec3 diffuse_transmission{0};  ///< cosine term for light from behind
    glm::dvec3 specular{0};
    double shininess = 32;  ///< Phong exponent n
    glm::dvec3 reflection{0};
    glm::dvec3 transmission{0};
    double ior = 1;  ///< index of refraction inside; 1 outside
    /// True: `reflection`, `specular` and `transmission` hold at normal incidence and go over into the
    /// grazing values below by Schlick's (1 - cos)^5 [schlick1994].
    bool fresnel = false;
    glm::dvec3 reflection_grazing{1}, specular_grazing{1}, transmission_grazing{0};  ///< with `fresnel` only
    /// Exponents of the lobes cos^n in which mirrored and refracted rays spread about their exact direction;
    /// infinity: no spread. A trace averages lobes that are wider than the lens (lobe_means.h) and takes the
    /// exact direction for the others.
    double reflection_exponent = std::numeric_limits<double>::infinity();
    double transmission_exponent = std::numeric_limits<double>::infinity();
    glm::dvec3 emission{0};
    /// Multiplies ambient, diffuse, diffuse_transmission; null: white.
    std::shared_ptr<const Texture> colour_texture;
    /// Multiplies emission; null: white.
    std::shared_ptr<const Texture> emission_texture;
    /// Whether mirrored rays carry light, at some angle.
    [[nodiscard]] bool reflects() const {
        return reflection != glm::dvec3(0) || (fresnel && reflection_grazing != glm::dvec3(0));
    }
    /// Whether lights make highlights, at some angle.
    [[nodiscard]] bool has_highlight() const {
        return specular != glm::dvec3(0) || (fresnel && specular_grazing != glm::dvec3(0));
    }
    /// Whether lights change its radiance.
    [[nodiscard]] bool answers_lights() const {
        return diffuse != glm::dvec3(0) || has_highlight() || diffuse_transmission != glm::dvec3(0);
    }
    /// Whether it reflects or transmits into a lobe of directions.
    [[nodiscard]] bool has_lobe() const {
        return (reflects() && std::isfinite(reflection_exponent)) ||
               (transmission != glm::dvec3(0) && std::isfinite(transmission_exponent));
    }
};

// Shapes in object space. Outward normals decide which side is inside for refraction.
struct Sphere {
    glm::dvec3 centre{0};
    double radius = 1;
};
struct Box {
    glm::dvec3 min{-0.5}, max{0.5};
};
struct Disc {  // in the plane through centre
    glm::dvec3 centre{0}, normal{0, 0, 1};
    double radius = 1, inner_radius = 0;
};
struct Rectangle {  // corner + a * edge_u + b * edge_v, 0 <= a, b <= 1; normal edge_u x edge_v; u = a, v = b
    glm::dvec3 corner{0}, edge_u{1, 0, 0}, edge_v{0, 1, 0};
};
struct Plane {  // infinite
    glm::dvec3 point{0}, normal{0, 0, 1};
};
/// Cylinder and cone are one: radius changes linearly from base to apex; u from +X about the axis towards +Y,
/// v from base to apex (the object's own axes; see docs/scene_format.md for an axis that is not +Z).
struct Cone {
    glm::dvec3 base{0}, apex{0, 0, 1};
    double base_radius = 1, apex_radius = 1;
    bool capped = false;
};
struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    std::vector<glm::vec3> normals;  ///< per position, or empty for flat shading
    std::vector<glm::vec2> uvs;      ///< per position, or empty
    std::vector<glm::vec3>
        colours;  ///< per position, or empty: multiply the material's colour_texture; 0 to 1
};
using Shape = std::variant<Sphere, Box, Disc, Rectangle, Plane, Cone, std::shared_ptr<const Mesh>>;

struct Object {
    std::string name;
    std::uint32_t id = 0;  ///< >= 1; several shapes may share one (the six planes of a compound, an NFF file)
    std::size_t material = 0;
    Shape shape;
    glm::dmat4 world_from_object{1};  ///< at rest; affine
    /// Keyframed motion applied after world_from_object is replaced: world = key(t) * motion_base. Empty:
    /// still.
    std::vector<TransformKey> keys;
    glm::dmat4 motion_base{1};
    bool casts_shadows = true;  ///< false: light passes, e.g. for the glowing ball around a point light
};

struct Light {
    enum class Kind { point, directional, spot, sphere, rectangle };
    Kind kind = Kind::point;
    std::string name;
    glm::dvec3 position{0};          ///< point, spot; centre of a sphere or rectangle
    glm::dvec3 direction{0, 0, -1};  ///< directional, spot: the way the light travels, unit length
    glm::dvec3 intensity{1};         ///< radiance factor at N.L = 1
    double cone_degrees = 30;        ///< spot: full angle of the lit cone
    double cone_soft_degrees =
        0;  ///< spot: full angle at which the fall-off begins; = cone_degrees: hard edge
    glm::dvec3 attenuation{1, 0, 0};  ///< 1 / (a0 + a1 r + a2 r^2), r in m
    /// Lights with an extent give penumbrae.
    double radius = 0;                ///< sphere
    glm::dvec3 edge_u{0}, edge_v{0};  ///< rectangle
    [[nodiscard]] bool has_extent() const { return kind == Kind::sphere || kind == Kind::rectangle; }
    bool casts_shadows = true;
    std::vector<TransformKey> keys;  ///< moves position and direction; empty: still
};

struct Camera {
    enum class Projection { perspective, orthographic };
    std::string name = "camera";
    Projection projection = Projection::perspective;
    glm::dvec3 position{0};
    glm::dvec3 look_at{0, 0, -1};
    glm::dvec3 up{0, 1, 0};
    double film_width_mm = 36;
    /// Perspective, one of: film distance (d, = focal length of the pinhole picture), or an angle.
    std::optional<double> focal_length_mm;
    std::optional<double> horizontal_fov_degrees;
    std::optional<double> vertical_fov_degrees;
    /// True: the angle runs between the centres of the first and the last row (column) of pixels, as NFF has
    /// it.
    bool fov_between_pixel_centres = false;
    double orthographic_width_m = 1;
    int width = 960, height = 540;   ///< raster, px
    std::optional<double> f_number;  ///< defaults for the lens, carried into the sample file
    std::optional<double> focus_m;
    std::optional<double> exposure_s;
    std::vector<TransformKey> keys;  ///< rigid motion; empty: still
};

/// In memory 1 is white: colours of light (intensities, emission, background, ambient_light) are the file's
/// times 2^exposure_stops (tracer/exposure.h).
struct Scene {
    std::string name;
    std::string sha256;                           ///< of the file and of everything it refers to
    std::vector<std::filesystem::path> referred;  ///< the files that it refers to, where they are
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::vector<Light> lights;
    std::vector<Camera> cameras;  ///< the first is the default
    glm::dvec3 background{0};
    glm::dvec3 ambient_light{1};  ///< Ia
    double exposure_stops = 0;    ///< as `expose` has set it
    /// By which photometric lights were divided; absent: the file has no such lights.
    std::optional<double> lumens_per_watt;
    double time_s = 0;               ///< default instant
    std::vector<std::string> notes;  ///< what the reader made up or skipped; shown to the user as warnings
};

struct SceneReadOptions {
    double metres_per_unit = 1;    ///< > 0 finite; lengths in the file are multiplied by it
    double lumens_per_watt = 683;  ///< > 0 finite; glTF's lux and candelas are divided by it
};

/// Whether `read_scene` knows the file's ending.
[[nodiscard]] bool is_scene_file(const std::filesystem::path& path);

/// By the file's ending: .toml, .nff, .gltf, .glb, .obj, .ply. Throws Error(invalid_input)
/// "FILE:LINE[:COLUMN]: ...".
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, const SceneReadOptions& options = {});

}  // namespace postlens
