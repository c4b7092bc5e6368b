#include "scene/mesh/ply_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "scene/mesh/ply_header.h"

namespace postlens {
namespace {

// Returns the index of the property that has one of the given names, or empty if there is none.
std::optional<std::size_t> place_of(const PlyElement& e, std::initializer_list<std::string_view> names,
                                    bool is_list) {
    for (const std::string_view name : names) {
        for (std::size_t i = 0; i < e.properties.size(); ++i) {
            const PlyProperty& p = e.properties[i];
            if (p.name == name && (p.count_type != PlyType::none) == is_list) return i;
        }
    }
    return std::nullopt;
}

// Finds `count` properties of a PLY element, for example the coordinates of a vertex. Each property may have
// one of several names, which `names` lists. Returns the indices of the properties in the element, or empty
// if a property is missing.
template <std::size_t count>
std::optional<std::array<std::size_t, count>> places_of(
    const PlyElement& e, const std::array<std::initializer_list<std::string_view>, count>& names) {
    std::array<std::size_t, count> out{};
    for (std::size_t k = 0; k < count; ++k) {
        const auto at = place_of(e, names[k], false);
        if (!at) return std::nullopt;
        out[k] = *at;
    }
    return out;
}

// Returns the number by which a file of this type stores the full intensity 1 of a colour. It is 1 for
// floating-point numbers, 65535 for 16-bit integers and 255 for 8-bit integers. Files with 32-bit integers
// are assumed to use only the range of a byte.
double white(PlyType type) {
    if (type == PlyType::float32 || type == PlyType::float64) return 1;
    return type == PlyType::int16 || type == PlyType::uint16 ? 65535 : 255;
}

class PlyReader {
  public:
    PlyReader(std::string_view bytes, const std::string& file, SceneNotes& notes)
        : rest_(bytes), file_(file), notes_(notes) {}

    PlyFile read() {
        const PlyHeader header = take_ply_header(rest_, file_);
        format_ = header.format;
        out_.texture_file = header.texture_file;
        bool has_vertices = false;
        for (const PlyElement& e : header.elements) {
            if (e.properties.empty() && e.count > 0)
                fail_here("element {} has no properties", excerpt(e.name));
            if (e.name == "vertex") {
                if (std::exchange(has_vertices, true)) fail_here("has two elements 'vertex' (expected one)");
                read_vertices(e);
            } else if (e.name == "face" || e.name == "tristrips") {
                read_faces(e);
            } else {
                if (e.count > 0) notes_.add(fmt::format("the element {} is left out", excerpt(e.name)));
                for (std::uint64_t i = 0; i < e.count; ++i) read_instance(e);
            }
        }
        if (!has_vertices) fail_here("has no element 'vertex'");
        return std::move(out_);
    }

  private:
    template <typename... Args>
    [[noreturn]] void fail_here(fmt::format_string<Args...> text, Args&&... args) const {
        fail(ExitCode::invalid_input, "{}: {}", file_, fmt::format(text, std::forward<Args>(args)...));
    }

    void read_vertices(const PlyElement& e) {
        const auto position = places_of<3>(e, {{{"x"}, {"y"}, {"z"}}});
        if (!position) fail_here("its element 'vertex' lacks a coordinate (expected properties x, y and z)");
        const auto normal = places_of<3>(e, {{{"nx"}, {"ny"}, {"nz"}}});
        const auto uv = places_of<2>(e, {{{"u", "s", "tx", "texture_u"}, {"v", "t", "ty", "texture_v"}}});
        const auto colour = places_of<3>(
            e,
            {{{"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}}});
        for (std::uint64_t i = 0; i < e.count; ++i) {
            read_instance(e);
            const auto three = [&](const std::array<std::size_t, 3>& at) {
                return glm::dvec3(scalars_[at[0]], scalars_[at[1]], scalars_[at[2]]);
            };
            out_.positions.push_back(three(*position));
            if (normal) out_.normals.push_back(three(*normal));
            if (uv) out_.uvs.emplace_back(scalars_[(*uv)[0]], scalars_[(*uv)[1]]);
            if (!colour) continue;
            glm::dvec3 c = three(*colour);
            for (std::size_t k = 0; k < 3; ++k)
                c[static_cast<int>(k)] /= white(e.properties[(*colour)[k]].type);
            out_.colours.push_back(c);
        }
    }

    void read_faces(const PlyElement& e) {
        const auto corners = place_of(e, {"vertex_indices", "vertex_index"}, true);
        if (!corners && e.count > 0) fail_here("its element {} has no list vertex_indices", excerpt(e.name));
        const auto uvs = place_of(e, {"texcoord"}, true);
        if (place_of(e, {"red", "r", "diffuse_red"}, false)) notes_.add("colours of faces are left out");
        kept_lists_ = {corners, uvs};
        for (std::uint64_t i = 0; i < e.count; ++i) {
            read_instance(e);
            e.name == "face" ? add_face(uvs.has_value()) : add_strips();
        }
        kept_lists_ = {};
    }

    void add_face(bool has_uvs) {
        const auto& [corners, uvs] = lists_;
        for (const double c : corners) out_.corners.push_back(index(c));
        out_.corner_counts.push_back(static_cast<std::uint32_t>(corners.size()));
        if (!has_uvs || uvs.empty()) return;
        if (uvs.size() != 2 * corners.size()) {
            fail_here(
                "a face has a wrong number of texture coordinates (got {}; expected 2 for each of {} "
                "corners)",
                uvs.size(), corners.size());
        }
        // Corners of earlier faces without texture coordinates get (0, 0).
        out_.corner_uvs.resize(out_.corners.size() - corners.size(), glm::dvec2(0));
        for (std::size_t i = 0; i < corners.size(); ++i)
            out_.corner_uvs.emplace_back(uvs[2 * i], uvs[2 * i + 1]);
    }

    // Adds the triangles of strips. An index of -1 ends a strip.
    // Every second triangle of a strip is reversed, so that all have the same winding.
    // Triangles with repeated corners, which only join parts of a strip, are omitted.
    void add_strips() {
        const auto& corners = lists_[0];
        std::size_t from = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (corners[i] == -1) {
                from = i + 1;
                continue;
            }
            const std::uint32_t c = index(corners[i]);
            if (i < from + 2) continue;
            std::uint32_t a = index(corners[i - 2]), b = index(corners[i - 1]);
            if (a == b || b == c || c == a) continue;
            if ((i - from) % 2 == 1) std::swap(a, b);
            out_.corners.insert(out_.corners.end(), {a, b, c});
            out_.corner_counts.push_back(3);
        }
    }

    [[nodiscard]] std::uint32_t index(double value) const {
        if (!(value >= 0 && value <= std::numeric_limits<std::uint32_t>::max()) || value != std::floor(value))
            fail_here("a face refers to no vertex (got {}; expected a whole number from 0)", value);
        return static_cast<std::uint32_t>(value);
    }

    // Reads one instance of a PLY element, such as one vertex or one face. Scalar properties are stored by
    // their index. Of the list properties, only those in `kept_lists_` are stored.
    void read_instance(const PlyElement& e) {
        scalars_.resize(e.properties.size());
        for (std::size_t k = 0; k < e.properties.size(); ++k) {
            const PlyProperty& p = e.properties[k];
            if (p.count_type == PlyType::none) {
                scalars_[k] = value(e, p.type);
                continue;
            }
            const std::uint64_t count = list_count(e, p);
            std::vector<double>* kept = nullptr;
            for (std::size_t i = 0; i < lists_.size(); ++i) {
                if (kept_lists_[i] == k) kept = &lists_[i];
            }
            if (kept) kept->clear();
            if (!kept && format_ != PlyFormat::ascii) {
                rest_.remove_prefix(static_cast<std::size_t>(count) * bytes_of(p.type));
                continue;
            }
            for (std::uint64_t i = 0; i < count; ++i) {
                const double v = value(e, p.type);
                if (kept) kept->push_back(v);
            }
        }
    }

    std::uint64_t list_count(const PlyElement& e, const PlyProperty& p) {
        const double count = value(e, p.count_type);
        if (!(count >= 0) || count != std::floor(count)) {
            fail_here("element {} has a list whose count is no whole number (got {})", excerpt(e.name),
                      count);
        }
        const std::size_t entry_bytes = format_ == PlyFormat::ascii ? 1 : bytes_of(p.type);
        if (count > static_cast<double>(rest_.size() / entry_bytes)) fail_short(e);
        return static_cast<std::uint64_t>(count);
    }

    [[noreturn]] void fail_short(const PlyElement& e) const {
        fail_here("ends in its element {} (expected {} of them)", excerpt(e.name), e.count);
    }

    double value(const PlyElement& e, PlyType type) {
        if (format_ == PlyFormat::ascii) {
            const std::string_view w = word(e);
            const auto number = parse_number(w);
            if (!number) {
                fail_here("element {} has something else than a number (got {})", excerpt(e.name),
                          excerpt(w));
            }
            return *number;
        }
        switch (type) {
            case PlyType::none:
                break;
            case PlyType::int8:
                return static_cast<std::int8_t>(bits<std::uint8_t>(e));
            case PlyType::uint8:
                return bits<std::uint8_t>(e);
            case PlyType::int16:
                return static_cast<std::int16_t>(bits<std::uint16_t>(e));
            case PlyType::uint16:
                return bits<std::uint16_t>(e);
            case PlyType::int32:
                return static_cast<std::int32_t>(bits<std::uint32_t>(e));
            case PlyType::uint32:
                return bits<std::uint32_t>(e);
            case PlyType::float32:
                return static_cast<double>(std::bit_cast<float>(bits<std::uint32_t>(e)));
            case PlyType::float64:
                return std::bit_cast<double>(bits<std::uint64_t>(e));
        }
        return 0;
    }

    template <typename T>
    T bits(const PlyElement& e) {
        if (rest_.size() < sizeof(T)) fail_short(e);
        std::uint64_t out = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            const std::size_t at = format_ == PlyFormat::little_endian ? sizeof(T) - 1 - i : i;
            out = out << 8 | static_cast<unsigned char>(rest_[at]);
        }
        rest_.remove_prefix(sizeof(T));
        return static_cast<T>(out);
    }

    // Returns the next word of an ASCII file. Skips lines that begin with "comment" or "obj_info".
    std::string_view word(const PlyElement& e) {
        for (;;) {
            const std::size_t from = rest_.find_first_not_of(" \t\r\n");
            if (from == std::string_view::npos) fail_short(e);
            is_line_start_ =
                is_line_start_ || rest_.substr(0, from).find_first_of("\r\n") != std::string_view::npos;
            rest_.remove_prefix(from);
            const std::size_t end = std::min(rest_.find_first_of(" \t\r\n"), rest_.size());
            const std::string_view out = rest_.substr(0, end);
            rest_.remove_prefix(end);
            const bool is_comment = is_line_start_ && (out == "comment" || out == "obj_info");
            is_line_start_ = false;
            if (!is_comment) return out;
            rest_.remove_prefix(std::min(rest_.find_first_of("\r\n"), rest_.size()));
        }
    }

    std::string_view rest_;
    const std::string& file_;
    SceneNotes& notes_;
    PlyFormat format_ = PlyFormat::ascii;
    PlyFile out_;
    std::vector<double> scalars_;
    // A PLY face may have many list properties, but only two are needed: vertex indices and texture
    // coordinates. `kept_lists_` contains the property index of each, and `lists_` its values for the current
    // face.
    std::array<std::optional<std::size_t>, 2> kept_lists_;
    std::array<std::vector<double>, 2> lists_;
    bool is_line_start_ = true;
};

}  // namespace

PlyFile read_ply_file(std::string_view bytes, const std::string& file, SceneNotes& notes) {
    return PlyReader(bytes, file, notes).read();
}

}  // namespace postlens
