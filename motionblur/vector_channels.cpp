#include "motionblur/vector_channels.h"

#include <algorithm>

#include "core/error.h"
#include "records/foreign_channels.h"

namespace postlens {
namespace {

using Names = std::vector<std::string>;

bool has(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<VectorChannels> find_forward(const Names& names, const std::string& hero_view) {
    const glm::dvec2 v_upwards{1, -1};
    const auto has_both = [&](const std::string& stem) {
        return has(names, stem + ".u") && has(names, stem + ".v");
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
        if (has_both(stem)) return VectorChannels{stem + ".u", stem + ".v", v_upwards, ""};
    }
    return std::nullopt;
}

std::optional<VectorChannels> find_next_frame_pass(const Names& names) {
    const std::string pass = "Vector.Z";
    for (const std::string& n : names) {
        if (!n.ends_with(pass)) continue;
        const std::string layer = n.substr(0, n.size() - pass.size());
        if (!layer.empty() && layer.back() != '.') continue;
        // This frame's place minus the next one's, upwards.
        if (has(names, layer + "Vector.W")) return VectorChannels{n, layer + "Vector.W", {-1, 1}, layer};
    }
    return std::nullopt;
}

std::optional<VectorChannels> find_by_names(const Names& names, const std::string& hero_view) {
    if (auto found = find_forward(names, hero_view)) return found;
    if (auto found = find_next_frame_pass(names)) return found;
    for (const std::string stem : {"motion", "velocity"}) {
        if (has(names, stem + ".x") && has(names, stem + ".y"))
            return VectorChannels{stem + ".x", stem + ".y", {1, 1}, ""};
    }
    return std::nullopt;
}

}  // namespace

VectorChannels find_vector_channels(const Names& names, const std::string& hero_view,
                                    const VectorChoice& choice, const std::string& source) {
    VectorChannels out;
    if (choice.channels) {
        out.u = choice.channels->first;
        out.v = choice.channels->second;
        for (const std::string& name : {out.u, out.v}) {
            if (!has(names, name)) {
                fail(ExitCode::invalid_input, "{}: no channel {} (got {}; expected what --vectors names)",
                     source, name, listed(names));
            }
        }
        // The passes of one layer belong together.
        if (const auto dot = out.u.rfind(".Vector."); dot != std::string::npos)
            out.layer = out.u.substr(0, dot + 1);
    } else if (const auto known = find_by_names(names, hero_view)) {
        out = *known;
    } else {
        fail(ExitCode::invalid_input,
             "{}: no motion vectors (got channels {}; expected forward.u and .v, Vector.Z and .W, motion.x "
             "and .y, "
             "velocity.x and .y, or --vectors U,V)",
             source, listed(names));
    }
    out.scale = choice.scale.value_or(out.scale);
    return out;
}

}  // namespace postlens
