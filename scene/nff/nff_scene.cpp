#include "scene/nff/nff_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "core/text.h"
#include "records/motion/scene_limits.h"
#include "scene/nff/nff_tokens.h"
#include "scene/nff/polygon_run.h"
#include "scene/scene_defaults.h"

namespace postlens {
namespace {

using glm::dvec3;

// The numbers of an `f` (fill colour) line of an NFF file: R G B Kd Ks Shine T ior. Defaults replace missing
// numbers or a missing line.
using Fill = std::array<double, 8>;
constexpr Fill default_fill{1, 1, 1, 0.8, 0, 32, 0, 1};

class NffReader {
  public:
    NffReader(const std::filesystem::path& path, double metres_per_unit)
        : path_(path), tokens_(path), unit_(metres_per_unit), largest_(largest_length_m / metres_per_unit) {
        scene_.name = path.stem().string();
    }

    Scene read() {
        while (const auto word = tokens_.next()) read_entity(*word);
        end_run();
        finish();
        return std::move(scene_);
    }

  private:
    void read_entity(std::string_view word) {
        if (word == "v") return read_view();
        if (word == "b") return read_background();
        if (word == "l") return read_light();
        if (word == "f") return read_fill();
        if (word == "s") return read_sphere();
        if (word == "c") return read_cone();
        if (word == "p") return read_polygon(false);
        if (word == "pp") return read_polygon(true);
        if (word == "tess") {
            note("'tess' is an extension of the format and is skipped: curved shapes are exact");
            std::ignore = tokens_.rest_of_line();
            return;
        }
        if (parse_number(word)) {
            tokens_.fail_here(
                "more numbers than the entity before has (got {}; expected v, b, l, f, c, s, p or pp)",
                excerpt(word));
        }
        tokens_.fail_here("unknown entity (got {}; expected v, b, l, f, c, s, p or pp)", excerpt(word));
    }

    dvec3 read_vector(std::string_view what) {
        dvec3 v;
        for (int i = 0; i < 3; ++i) v[i] = tokens_.number(what, largest_);
        return v;
    }
    dvec3 read_point(std::string_view what) { return unit_ * read_vector(what); }

    double colour_channel(std::string_view word, std::string_view what) const {
        const double value = tokens_.number(word, what, largest_colour);
        if (value < 0) tokens_.fail_here("{} is out of range (got {}; expected at least 0)", what, value);
        return value;
    }

    void read_view() {
        Camera camera;
        camera.name = scene_.cameras.empty() ? "view" : fmt::format("view {}", scene_.cameras.size() + 1);
        camera.fov_between_pixel_centres = true;
        constexpr std::array<std::string_view, 6> fields{"from", "at", "up", "angle", "resolution", "hither"};
        std::array<bool, fields.size()> seen{};
        for (;;) {
            const auto word = tokens_.peek();
            const auto field = word ? std::find(fields.begin(), fields.end(), *word) : fields.end();
            if (field == fields.end()) break;
            std::ignore = tokens_.next();
            bool& is_seen = seen[static_cast<std::size_t>(field - fields.begin())];
            if (is_seen) tokens_.fail_here("the view has '{}' twice", *field);
            is_seen = true;
            if (*field == "from") camera.position = read_point("'from'");
            if (*field == "at") camera.look_at = read_point("'at'");
            if (*field == "up") camera.up = read_vector("'up'");
            if (*field == "angle") camera.vertical_fov_degrees = read_angle();
            if (*field == "resolution") {
                camera.width = read_resolution();
                camera.height = read_resolution();
            }
            // 'hither' is the distance of the near clipping plane, which a ray tracer does not need.
            if (*field == "hither") std::ignore = tokens_.number("'hither'", largest_);
        }
        for (std::size_t i = 0; i + 1 < fields.size(); ++i) {
            if (!seen[i]) tokens_.fail_here("the view has no '{}'", fields[i]);
        }
        const dvec3 forward = camera.look_at - camera.position;
        if (!(glm::length(glm::cross(forward, camera.up)) >
              1e-9 * glm::length(forward) * glm::length(camera.up))) {
            tokens_.fail_here("'from', 'at' and 'up' do not span a view");
        }
        scene_.cameras.push_back(camera);
    }

    double read_angle() {
        const double degrees = tokens_.number("'angle'", largest_length_m);
        if (!(degrees > 0 && degrees < 180)) {
            tokens_.fail_here("'angle' is out of range (got {}; expected more than 0, less than 180 degrees)",
                              degrees);
        }
        return degrees;
    }

    int read_resolution() {
        const double pixels = tokens_.number("'resolution'", largest_length_m);
        // The field of view of an NFF file, 'angle', is measured between the centres of the first and the
        // last row of pixels. With a single row, this angle would be 0. Therefore, the image must have at
        // least two rows.
        if (!(pixels >= 2 && pixels <= largest_raster_px) || pixels != std::floor(pixels)) {
            tokens_.fail_here("'resolution' is out of range (got {}; expected a whole number of 2 to {} px)",
                              pixels, largest_raster_px);
        }
        return static_cast<int>(pixels);
    }

    void read_background() {
        const auto words = tokens_.rest_of_line();
        if (words.size() != 3) tokens_.fail_here("a background has three numbers (got {})", words.size());
        for (int i = 0; i < 3; ++i) {
            scene_.background[i] = colour_channel(words[static_cast<std::size_t>(i)], "background");
        }
    }

    void read_light() {
        const auto words = tokens_.rest_of_line();
        if (words.size() != 3 && words.size() != 6) {
            tokens_.fail_here("a light has three numbers, or six with a colour (got {})", words.size());
        }
        Light light;
        light.name = fmt::format("light {}", scene_.lights.size() + 1);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto axis = static_cast<int>(i);
            light.position[axis] = unit_ * tokens_.number(words[i], "light position", largest_);
            light.intensity[axis] = words.size() == 6 ? colour_channel(words[i + 3], "light colour") : 1.0;
        }
        scene_.lights.push_back(light);
    }

    void read_fill() {
        end_run();
        const auto words = tokens_.rest_of_line();
        Fill fill = default_fill;
        std::size_t count = 0;
        while (count < words.size() && parse_number(words[count])) {
            if (count == fill.size()) tokens_.fail_here("a fill has eight numbers (got more)");
            fill[count] = colour_channel(words[count], "fill");
            ++count;
        }
        for (std::size_t i = count; i < words.size(); ++i) {
            if (parse_number(words[i]))
                tokens_.fail_here("fill is not a number (got {})", excerpt(words[count]));
        }
        if (count < 3) tokens_.fail_here("a fill has eight numbers, at least its colour (got {})", count);
        if (count < words.size())
            note("a texture name after 'f' is an extension of the format and is skipped");
        if (count < fill.size()) {
            note(
                "an 'f' line has fewer than eight numbers; the missing ones are taken as Kd 0.8, Ks 0, Shine "
                "32, T 0, "
                "index 1");
        }
        if (fill[4] > 1 || fill[6] > 1) note("an 'f' line has Ks or T above 1; taken as 1");
        fill[4] = std::min(fill[4], 1.0);
        fill[6] = std::min(fill[6], 1.0);
        if (fill[6] == 0)
            fill[7] = 1;  // an opaque material does not use the index, which may be 0 in published files
        if (!(fill[7] > 0))
            tokens_.fail_here("index of refraction is out of range (got {}; expected above 0)", fill[7]);
        material_ = material_of(fill);
    }

    std::size_t material_of(const Fill& fill) {
        const auto [at, is_new] = materials_.try_emplace(fill, scene_.materials.size());
        if (!is_new) return at->second;
        const auto& [red, green, blue, kd, ks, shine, transmittance, ior] = fill;
        const dvec3 colour(red, green, blue);
        Material material;
        material.name = fmt::format("fill {}", scene_.materials.size() + 1);
        material.ambient = kd * colour;
        material.diffuse = kd * colour;
        material.specular = dvec3(ks);
        material.shininess = shine;
        material.reflection = dvec3(ks);
        material.transmission = glm::min(transmittance * colour, dvec3(1));
        material.ior = ior;
        scene_.materials.push_back(material);
        return at->second;
    }

    std::size_t current_material() {
        if (!material_) {
            note("an object stands before any 'f' line; it is white with Kd 0.8");
            material_ = material_of(default_fill);
        }
        return *material_;
    }

    void add_object(std::string name, Shape shape, std::size_t material) {
        Object object;
        object.name = std::move(name);
        object.id = static_cast<std::uint32_t>(scene_.objects.size() + 1);
        object.material = material;
        object.shape = std::move(shape);
        scene_.objects.push_back(std::move(object));
    }

    double read_radius(std::string_view what) {
        const double radius = unit_ * tokens_.number(what, largest_);
        if (radius < 0) note("a negative radius asks for the inside only; both sides are visible here");
        return std::abs(radius);
    }

    void skip_extra_numbers(std::string_view entity) {
        if (!tokens_.rest_of_line().empty()) {
            note(fmt::format(
                "numbers after the radius of an '{}' are an extension of the format and are skipped",
                entity));
        }
    }

    void read_sphere() {
        end_run();
        Sphere sphere;
        sphere.centre = read_point("sphere centre");
        sphere.radius = read_radius("sphere radius");
        if (!(sphere.radius >= smallest_extent_m)) {
            tokens_.fail_here("sphere radius is out of range (got {}; expected at least {} m)", sphere.radius,
                              smallest_extent_m);
        }
        skip_extra_numbers("s");
        add_object(fmt::format("sphere {}", ++spheres_), sphere, current_material());
    }

    void read_cone() {
        end_run();
        Cone cone;
        cone.base = read_point("cone base");
        cone.base_radius = read_radius("cone base radius");
        cone.apex = read_point("cone apex");
        cone.apex_radius = read_radius("cone apex radius");
        if (!(std::max(cone.base_radius, cone.apex_radius) >= smallest_extent_m)) {
            tokens_.fail_here(
                "both radii of a cone are out of range (got {} and {}; expected one of at least {} m)",
                cone.base_radius, cone.apex_radius, smallest_extent_m);
        }
        if (!(glm::length(cone.apex - cone.base) >= smallest_extent_m)) {
            tokens_.fail_here("base and apex of a cone coincide (expected at least {} m between them)",
                              smallest_extent_m);
        }
        skip_extra_numbers("c");
        add_object(fmt::format("cone {}", ++cones_), cone, current_material());
    }

    void read_polygon(bool is_patch) {
        const double wanted = tokens_.number("number of vertices", 1e18);
        if (!(wanted >= 3 && wanted <= static_cast<double>(largest_polygon)) ||
            wanted != std::floor(wanted)) {
            tokens_.fail_here(
                "number of vertices is out of range (got {}; expected a whole number of 3 to {})", wanted,
                largest_polygon);
        }
        const int first_line = tokens_.line();
        corners_.clear();
        corner_normals_.clear();
        for (int i = 0; i < static_cast<int>(wanted); ++i) {
            corners_.push_back(read_point("vertex"));
            if (is_patch) corner_normals_.push_back(read_vector("vertex normal"));
        }
        const std::size_t material = current_material();
        const PolygonFault fault = run_.add(corners_, corner_normals_);
        if (fault == PolygonFault::no_area) note("a polygon without area is skipped", first_line);
        if (fault == PolygonFault::crosses_itself) tokens_.fail_here("the polygon crosses itself");
        run_material_ = material;
    }

    void end_run() {
        if (run_.empty()) return;
        add_object(fmt::format("polygons {}", ++runs_), std::make_shared<const Mesh>(run_.take()),
                   run_material_);
    }

    void note(const std::string& text) { note(text, tokens_.line()); }
    void note(const std::string& text, int line) {
        const auto [at, is_new] = notes_.try_emplace(text, notes_in_order_.size());
        if (is_new) notes_in_order_.push_back({text, line, 0});
        ++notes_in_order_[at->second].count;
    }

    void finish() {
        scene_.sha256 = tokens_.sha256();
        for (const Note& n : notes_in_order_) {
            scene_.notes.push_back(
                n.count == 1 ? fmt::format("{}:{}: {}", path_.string(), n.line, n.text)
                             : fmt::format("{}:{}: {} ({} times)", path_.string(), n.line, n.text, n.count));
        }
        // Scales the intensities of the n lights by sqrt(n) / (2 n), so that the total brightness grows only
        // with the square root of n. This rule comes from the Standard Procedural Databases, the test scenes
        // for which the NFF format was made.
        const double lights = static_cast<double>(std::max<std::size_t>(scene_.lights.size(), 1));
        const double intensity = std::sqrt(lights) / (2 * lights);
        for (Light& light : scene_.lights) light.intensity *= intensity;
        scene_.ambient_light = dvec3(intensity);
        complete_scene(scene_, path_, true, intensity);
    }

    struct Note {
        std::string text;
        int line = 0, count = 0;
    };

    std::filesystem::path path_;
    NffTokens tokens_;
    double unit_ = 1, largest_ = 0;
    Scene scene_;
    std::map<Fill, std::size_t> materials_;
    std::optional<std::size_t> material_;
    int spheres_ = 0, cones_ = 0, runs_ = 0;
    std::vector<dvec3> corners_, corner_normals_;
    PolygonRun run_;
    std::size_t run_material_ = 0;
    std::map<std::string, std::size_t> notes_;
    std::vector<Note> notes_in_order_;
};

}  // namespace

Scene read_nff_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    return NffReader(path, options.metres_per_unit).read();
}

}  // namespace postlens
