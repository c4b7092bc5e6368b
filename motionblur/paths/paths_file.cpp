#include "motionblur/paths/paths_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "core/files/text_file.h"
#include "core/memory.h"
#include "core/text.h"
#include "core/toml_reader.h"
#include "records/motion/toml_transform.h"

namespace postlens {
namespace {

using Name = std::string_view;

std::vector<std::uint32_t> read_ids(const TomlTable& table) {
    constexpr double most = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> out;
    for (const double id : table.number_list("ids", {.min = 1, .max = most})) {
        if (id != std::floor(id))
            table.fail_at("ids", "'ids' is not whole (got {}; expected whole numbers)", id);
        out.push_back(static_cast<std::uint32_t>(id));
    }
    return out;
}

glm::dvec2 read_vec2(const TomlTable& table, Name key) {
    const auto v =
        table.numbers(key, 2, {.min = -largest_path_coordinate_px, .max = largest_path_coordinate_px});
    return v ? glm::dvec2((*v)[0], (*v)[1]) : glm::dvec2(0);
}

void check_count(const TomlTable& table, Name key, std::size_t count) {
    if (count == 0) table.fail_at(key, "'{}' is empty (expected 1 or more)", key);
    if (count > most_knots)
        table.fail_at(key, "'{}' has too many (got {}; expected at most {})", key, count, most_knots);
}

ScreenPath read_screen_path(const TomlTable& table, const std::string& source) {
    static constexpr std::array<Name, 3> kinds{"polyline", "catmull-rom", "bezier"};
    static constexpr std::array<Name, 2> known{"time_s", "at_px"};
    static constexpr std::array<Name, 2> handles{"in_px", "out_px"};
    const auto kind = static_cast<PathKind>(table.choice("kind", kinds).value_or(0));
    const auto tables = table.tables("knots", table.what() + ": knot");
    check_count(table, "knots", tables.size());
    std::vector<PathKnot> knots;
    knots.reserve(tables.size());
    for (const TomlTable& t : tables) {
        for (const Name handle : handles) {
            if (kind != PathKind::bezier && t.has(handle))
                t.fail_at(handle, R"('{}' is for kind = "bezier" (got "{}"))", handle,
                          kinds[static_cast<std::size_t>(kind)]);
        }
        t.allow_only({known, handles});
        PathKnot knot;
        knot.time_s = t.required(
            t.number("time_s", {.min = -largest_path_time_s, .max = largest_path_time_s}), "time_s");
        if (!t.has("at_px")) t.fail_here("has no 'at_px' (expected one)");
        knot.at_px = read_vec2(t, "at_px");
        knot.in_px = read_vec2(t, "in_px");
        knot.out_px = read_vec2(t, "out_px");
        if (!knots.empty() && !(knot.time_s > knots.back().time_s)) {
            t.fail_at("time_s", "'time_s' does not grow (got {} s after {} s)", knot.time_s,
                      knots.back().time_s);
        }
        knots.push_back(knot);
    }
    return {kind, std::move(knots), source};
}

ObjectPath read_path(const TomlTable& table) {
    static constexpr std::array<Name, 5> known{"ids", "objects", "kind", "knots", "keys"};
    table.allow_only({known});
    ObjectPath out;
    out.source = table.line();
    if (table.has("ids")) out.ids = read_ids(table);
    out.objects = table.texts("objects").value_or(std::vector<std::string>{});
    if (out.ids.empty() && out.objects.empty())
        table.fail_here("moves nothing (expected 'ids' or 'objects' with 1 or more)");
    table.refuse_both("knots", "keys");
    if (table.has("keys")) {
        table.refuse_both("keys", "kind");
        RigidKeys keys = read_motion(table, 1, false);
        check_count(table, "keys", keys.size());
        out.motion = std::move(keys);
    } else if (table.has("knots")) {
        out.motion = read_screen_path(table, out.source);
    } else {
        table.fail_here("has no motion (expected 'knots' or 'keys')");
    }
    return out;
}

}  // namespace

std::vector<ObjectPath> read_paths(const std::filesystem::path& path) {
    const std::string file = path.string();
    // Parsed numbers need about 50 times the memory of their text.
    require_memory(50 * std::min(check_regular_file(path), largest_paths_bytes), file + ": reading it");
    const toml::table document = parse_toml(read_text_file(path, largest_paths_bytes), file);
    const TomlTable root(file, document, "paths file");
    static constexpr std::array<Name, 1> known{"path"};
    root.allow_only({known});
    std::vector<ObjectPath> out;
    std::set<std::uint32_t> seen;
    std::set<std::string> seen_names;
    for (const TomlTable& table : root.tables("path", "path")) {
        ObjectPath read = read_path(table);
        for (const std::uint32_t id : read.ids) {
            if (!seen.insert(id).second)
                table.fail_at("ids", "id {} is moved twice (expected one path for each)", id);
        }
        for (const std::string& name : read.objects) {
            if (!seen_names.insert(name).second) {
                table.fail_at("objects", "object {} is moved twice (expected one path for each)",
                              excerpt(name));
            }
        }
        out.push_back(std::move(read));
    }
    if (out.empty()) fail(ExitCode::invalid_input, "{}:1: no paths (expected [[path]] tables)", file);
    return out;
}

std::vector<std::vector<std::uint32_t>> resolve_ids(const std::vector<ObjectPath>& paths,
                                                    const std::map<std::uint32_t, std::string>& names) {
    std::multimap<Name, std::uint32_t> by_name;
    std::vector<Name> all_names;
    for (const auto& [id, name] : names) {
        by_name.emplace(name, id);
        all_names.push_back(name);
    }
    std::map<std::uint32_t, const ObjectPath*> moved;
    std::vector<std::vector<std::uint32_t>> out;
    for (const ObjectPath& path : paths) {
        std::vector<std::uint32_t> ids = path.ids;
        for (const std::uint32_t id : path.ids) {
            if (names.contains(id)) continue;
            fail(ExitCode::invalid_input, "{}: the sample file has no such id (got {}; expected {})",
                 path.source, id,
                 names.empty() ? "none"
                               : fmt::format("one of {} from {} to {}", names.size(), names.begin()->first,
                                             names.rbegin()->first));
        }
        for (const std::string& name : path.objects) {
            const auto [begin, end] = by_name.equal_range(name);
            if (begin == end) {
                fail(ExitCode::invalid_input,
                     "{}: the sample file has no such object (got {}; nearest name: {})", path.source,
                     excerpt(name), excerpt(nearest_word(name, all_names)));
            }
            for (auto it = begin; it != end; ++it) ids.push_back(it->second);
        }
        for (const std::uint32_t id : ids) {
            const auto [before, is_new] = moved.emplace(id, &path);
            if (is_new) continue;
            fail(ExitCode::invalid_input, "{}: id {} ({}) is moved twice (the other time at {})", path.source,
                 id, excerpt(names.at(id)), before->second->source);
        }
        out.push_back(std::move(ids));
    }
    return out;
}

FrameMotion motion_of(const SampleHeader& header, const std::vector<ObjectPath>& paths) {
    FrameMotion motion(header);
    const std::vector<std::vector<std::uint32_t>> ids = resolve_ids(paths, header.object_names);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        for (const std::uint32_t id : ids[i]) {
            if (const auto* keys = std::get_if<RigidKeys>(&paths[i].motion)) {
                motion.set_keys(id, *keys);
                continue;
            }
            const ScreenPath path = std::get<ScreenPath>(paths[i].motion);
            std::vector<double> breaks;
            for (const PathKnot& knot : path.knot_list()) breaks.push_back(knot.time_s);
            motion.set_displacement(
                id, [path](double t) { return path.at(t); }, std::move(breaks));
        }
    }
    return motion;
}

}  // namespace postlens
