#include "motionblur/vector_channels.h"

#include <algorithm>
#include <fmt/ranges.h>
#include <span>

#include "core/error.h"

namespace postlens {
namespace {

using Names = std::vector<std::string>;

std::optional<std::size_t> index_of(const Names& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names.begin());
}

/// What there is, in a line of bearable length.
std::string listed(const Names& names) {
    constexpr std::size_t most = 24;
    const auto shown = std::span(names).first(std::min(most, names.size()));
    return fmt::format("{}{}", fmt::join(shown, ", "),
                       names.size() > most ? fmt::format(" and {} more", names.size() - most) : "");
}

struct Found {
    std::string u, v, layer;  ///< layer: with its dot, or empty
    glm::dvec2 scale{1, 1};
};

std::optional<Found> find_forward(const Names& names, const std::string& hero_view) {
    const glm::dvec2 v_upwards{1, -1};
    const auto has = [&](const std::string& stem) {
        return index_of(names, stem + ".u") && index_of(names, stem + ".v");
    };
    Names stems{"forward"};
    if (!hero_view.empty()) {
        stems.push_back("forward." + hero_view);
    } else {
        for (const std::string& n : names) {
            if (n.starts_with("forward.") && n.ends_with(".u") && n.size() > 10)
                stems.push_back(n.substr(0, n.size() - 2));
        }
    }
    for (const std::string& stem : stems) {
        if (has(stem)) return Found{stem + ".u", stem + ".v", "", v_upwards};
    }
    return std::nullopt;
}

std::optional<Found> find_next_frame_pass(const Names& names) {
    const std::string pass = "Vector.Z";
    for (const std::string& n : names) {
        if (!n.ends_with(pass)) continue;
        const std::string layer = n.substr(0, n.size() - pass.size());
        if (!layer.empty() && layer.back() != '.') continue;
        // This frame's place minus the next one's, upwards.
        if (index_of(names, layer + "Vector.W")) return Found{n, layer + "Vector.W", layer, {-1, 1}};
    }
    return std::nullopt;
}

std::optional<Found> find_by_names(const Names& names, const std::string& hero_view) {
    if (auto found = find_forward(names, hero_view)) return found;
    if (auto found = find_next_frame_pass(names)) return found;
    for (const std::string stem : {"motion", "velocity"}) {
        if (index_of(names, stem + ".x") && index_of(names, stem + ".y"))
            return Found{stem + ".x", stem + ".y", "", {1, 1}};
    }
    return std::nullopt;
}

std::optional<std::size_t> first_of(const Names& names, const Names& wanted) {
    for (const std::string& name : wanted) {
        if (const auto i = index_of(names, name)) return i;
    }
    return std::nullopt;
}

}  // namespace

VectorChannels find_vector_channels(const Names& names, const std::string& hero_view,
                                    const VectorChoice& choice, const std::string& source) {
    Found found;
    if (choice.channels) {
        found.u = choice.channels->first;
        found.v = choice.channels->second;
        for (const std::string& name : {found.u, found.v}) {
            if (!index_of(names, name)) {
                fail(ExitCode::invalid_input, "{}: no channel {} (got {}; expected what --vectors names)",
                     source, name, listed(names));
            }
        }
        // The passes of one layer belong together.
        if (const auto dot = found.u.rfind(".Vector."); dot != std::string::npos)
            found.layer = found.u.substr(0, dot + 1);
    } else if (const auto known = find_by_names(names, hero_view)) {
        found = *known;
    } else {
        fail(ExitCode::invalid_input,
             "{}: no motion vectors (got channels {}; expected forward.u and .v, Vector.Z and .W, motion.x "
             "and .y, "
             "velocity.x and .y, or --vectors U,V)",
             source, listed(names));
    }
    VectorChannels out;
    out.u = *index_of(names, found.u);
    out.v = *index_of(names, found.v);
    out.u_name = found.u;
    out.v_name = found.v;
    out.scale = choice.scale.value_or(found.scale);
    const auto colour = [&](const std::string& letter) {
        return first_of(names, {letter, found.layer + "Combined." + letter});
    };
    const auto r = colour("R"), g = colour("G"), b = colour("B");
    if (!r || !g || !b) {
        fail(ExitCode::invalid_input, "{}: no colours (got channels {}; expected R, G and B)", source,
             listed(names));
    }
    out.r = *r;
    out.g = *g;
    out.b = *b;
    out.a = colour("A");
    out.z = first_of(names, {"Z", found.layer + "Depth.Z", found.layer + "Depth.V"});
    return out;
}

}  // namespace postlens
