// The scene in the form that the tracer uses: lengths in metres, scene-linear colours, all defaults filled
// in.
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

#include "records/motion/transform_key.h"
#include "scene/texture.h"

namespace postlens {

/// A material of Whitted's model, with a colour for each coefficient:
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
    /// If true, `reflection`, `specular` and `transmission` are the values at normal incidence.
    /// They approach the `_grazing` values with Schlick's weight (1 - cos)^5 [schlick1994].
    bool fresnel = false;
    glm::dvec3 reflection_grazing{1}, specular_grazing{1}, transmission_grazing{0};  ///< with `fresnel` only
    /// Exponents n of the lobes cos^n around the reflected and the refracted direction, which model a rough
    /// surface. Infinity means a smooth surface. The tracer averages over a lobe only if it is wider than the
    /// lens, as seen from the surface. Otherwise, it follows the exact direction.
    double reflection_exponent = std::numeric_limits<double>::infinity();
    double transmission_exponent = std::numeric_limits<double>::infinity();
    glm::dvec3 emission{0};
    /// Texture that multiplies `ambient`, `diffuse` and `diffuse_transmission`. Null means white.
    std::shared_ptr<const Texture> colour_texture;
    /// Texture that multiplies `emission`. Null means white.
    std::shared_ptr<const Texture> emission_texture;
    /// If true, `colour_texture` and the vertex colours of a mesh also multiply `emission`.
    bool emission_has_colour = false;
    /// Returns true if the material reflects rays at some angle.
    [[nodiscard]] bool reflects() const {
        return reflection != glm::dvec3(0) || (fresnel && reflection_grazing != glm::dvec3(0));
    }
    [[nodiscard]] bool has_highlight() const {
        return specular != glm::dvec3(0) || (fresnel && specular_grazing != glm::dvec3(0));
    }
    /// Returns true if the radiance of the material depends on the light sources.
    [[nodiscard]] bool answers_lights() const {
        return diffuse != glm::dvec3(0) || has_highlight() || diffuse_transmission != glm::dvec3(0);
    }
    /// Returns true if the material reflects or transmits glossily, into a lobe of directions.
    [[nodiscard]] bool has_lobe() const {
        return (reflects() && std::isfinite(reflection_exponent)) ||
               (transmission != glm::dvec3(0) && std::isfinite(transmission_exponent));
    }
};

// Shapes in object space. For refraction, the outside is the side to which the normal points.
struct Sphere {
    glm::dvec3 centre{0};
    double radius = 1;
};
struct Box {
    glm::dvec3 min{-0.5}, max{0.5};
};
struct Disc {  // in the plane through `centre` with normal `normal`
    glm::dvec3 centre{0}, normal{0, 0, 1};
    double radius = 1, inner_radius = 0;
};
struct Rectangle {  // corner + a * edge_u + b * edge_v, 0 <= a, b <= 1; normal edge_u x edge_v; u = a, v = b
    glm::dvec3 corner{0}, edge_u{1, 0, 0}, edge_v{0, 1, 0};
};
struct Plane {  // infinite
    glm::dvec3 point{0}, normal{0, 0, 1};
};
/// A cone or a cylinder. The radius changes linearly from base to apex.
/// The texture coordinate u runs around the axis (docs/scene_format.md), and v from base to apex.
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
        colours;  ///< one per position, or empty; multiplied by the material's colour_texture, 0 to 1
};
using Shape = std::variant<Sphere, Box, Disc, Rectangle, Plane, Cone, std::shared_ptr<const Mesh>>;

struct Object {
    std::string name;
    std::uint32_t id = 0;  ///< >= 1; the shapes of a compound object share one id
    std::size_t material = 0;
    Shape shape;
    glm::dmat4 world_from_object{1};  ///< at rest; affine
    /// Keyframes of the object's motion. If there are any, they replace `world_from_object`. The transform
    /// from the object to the world at time t is then key(t) * motion_base, where key(t) is the interpolated
    /// keyframe. So `motion_base` is applied first.
    std::vector<TransformKey> keys;
    glm::dmat4 motion_base{1};
    /// If false, the object casts no shadow. Example: a glowing ball around a point light.
    bool casts_shadows = true;
};

struct Light {
    enum class Kind { point, directional, spot, sphere, rectangle };
    Kind kind = Kind::point;
    std::string name;
    glm::dvec3 position{0};          ///< of a point or spot light, or the centre of a sphere or rectangle
    glm::dvec3 direction{0, 0, -1};  ///< unit direction in which the light travels (directional, spot)
    /// brightness of the light: the radiance of a surface that it illuminates, if the surface has a diffuse
    /// coefficient of 1 and faces the light (N.L = 1), and if there is no attenuation
    glm::dvec3 intensity{1};
    double cone_degrees = 30;  ///< spot: full angle of the lit cone
    double cone_soft_degrees =
        0;  ///< spot: full angle at which the fall-off begins; cone_degrees gives a hard edge
    /// factors a0, a1, a2 of the attenuation 1 / (a0 + a1 r + a2 r^2), where r is the distance in metres
    glm::dvec3 attenuation{1, 0, 0};
    /// Size, m, of a light that is not a point and therefore casts soft shadows.
    double radius = 0;                ///< sphere
    glm::dvec3 edge_u{0}, edge_v{0};  ///< rectangle
    [[nodiscard]] bool has_extent() const { return kind == Kind::sphere || kind == Kind::rectangle; }
    bool casts_shadows = true;
    std::vector<TransformKey> keys;  ///< motion of position and direction; empty if the light does not move
};

struct Camera {
    enum class Projection { perspective, orthographic };
    std::string name = "camera";
    Projection projection = Projection::perspective;
    glm::dvec3 position{0};
    glm::dvec3 look_at{0, 0, -1};
    glm::dvec3 up{0, 1, 0};
    double film_width_mm = 36;
    /// These three values determine the field of view of a perspective camera, so at most one of them is set.
    /// `focal_length_mm` is also the distance from the lens to the film, as for a lens focused at infinity.
    std::optional<double> focal_length_mm;
    std::optional<double> horizontal_fov_degrees;
    std::optional<double> vertical_fov_degrees;
    /// If true, the field of view is measured between the centres of the outermost pixels, as in NFF files.
    bool fov_between_pixel_centres = false;
    double orthographic_width_m = 1;
    int width = 960, height = 540;   ///< raster, px
    std::optional<double> f_number;  ///< default lens settings; copied to the sample file
    std::optional<double> focus_m;
    std::optional<double> exposure_s;
    std::vector<TransformKey> keys;  ///< rigid motion; empty if the camera does not move
};

/// A scene in memory. A radiance of 1 is white.
/// Intensities, emissions, background and ambient light are multiplied by 2^exposure_stops.
struct Scene {
    std::string name;
    std::string sha256;                           ///< SHA-256 of the file and all files to which it refers
    std::vector<std::filesystem::path> referred;  ///< paths of the files to which the scene refers
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::vector<Light> lights;
    std::vector<Camera> cameras;  ///< the first is the default
    glm::dvec3 background{0};
    glm::dvec3 ambient_light{1};  ///< Ia
    double exposure_stops = 0;    ///< set by `expose`
    /// The lights of a glTF file have photometric units (lux or candela). When the file was read, they were
    /// divided by this number of lumens per watt, to obtain radiometric units. Empty if the scene has no such
    /// lights.
    std::optional<double> lumens_per_watt;
    double metres_per_unit = 1;      ///< factor by which all lengths of the file were multiplied
    double time_s = 0;               ///< default time
    std::vector<std::string> notes;  ///< warnings about defaults and omitted contents
};

struct SceneReadOptions {
    double metres_per_unit = 1;    ///< finite, > 0; all lengths in the file are multiplied by it
    double lumens_per_watt = 683;  ///< finite, > 0; divides lux and candela values of glTF
};

/// Returns true if `read_scene` supports the extension of the file.
[[nodiscard]] bool is_scene_file(const std::filesystem::path& path);

/// Reads a scene from a file with the extension .toml, .nff, .gltf, .glb, .obj or .ply.
/// Throws Error(invalid_input) "FILE:LINE[:COLUMN]: ...".
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, const SceneReadOptions& options = {});

}  // namespace postlens
