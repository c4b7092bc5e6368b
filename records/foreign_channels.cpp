#include "records/foreign_channels.h"

#include <algorithm>
#include <fmt/ranges.h>
#include <utility>

#include "core/error.h"

namespace postlens {
namespace {

/// "R" or "r" behind the layer's name.
std::string colour(const ForeignPart& part, const std::string& layer, char letter) {
    const std::string upper = layer + letter, lower = layer + static_cast<char>(letter - 'A' + 'a');
    for (const std::string& name : {upper, lower}) {
        if (part.has(name)) return name;
    }
    return "";
}

std::string first_of(const ForeignPart& part, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (part.has(name)) return name;
    }
    return "";
}

bool has_colours(const ForeignPart& part, const std::string& layer) {
    return !colour(part, layer, 'R').empty() && !colour(part, layer, 'G').empty() &&
           !colour(part, layer, 'B').empty();
}

/// Lower is better.
int rank(const std::string& layer) {
    if (layer.empty()) return 0;
    if (layer.ends_with("Combined.")) return 1;
    for (const char* usual : {"rgba.", "beauty.", "Beauty.", "color.", "RGBA."}) {
        if (layer == usual) return 2;
    }
    // Sums of bits, not pictures.
    return layer.find("rypto") != std::string::npos ? 4 : 3;
}

bool is_asked(const ForeignPart& part, const std::string& layer, const std::string& asked) {
    if (asked.empty() || part.name == asked) return true;
    if (part.view == asked || (!part.views.empty() && part.views[0] == asked && layer.empty())) return true;
    return layer == asked + "." || layer.starts_with(asked + ".");
}

struct Candidate {
    std::size_t part = 0;
    std::string layer;
    int rank = 5;
};

std::optional<Candidate> best_colours(const ForeignFile& file, const std::string& asked) {
    std::optional<Candidate> best;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        const ForeignPart& part = file.parts()[i];
        for (const std::string& layer : colour_layers(part)) {
            if (!is_asked(part, layer, asked)) continue;
            if (!best || rank(layer) < best->rank) best = Candidate{i, layer, rank(layer)};
        }
    }
    return best;
}

/// What stands before "Combined.", where the layer is Blender's.
std::string view_layer(const std::string& layer) {
    const std::string pass = "Combined.";
    return layer.ends_with(pass) ? layer.substr(0, layer.size() - pass.size()) : layer;
}

std::string depth_of(const ForeignPart& part, const std::string& layer) {
    const std::string own = view_layer(layer);
    return first_of(part, {layer + "Z", own + "Depth.Z", own + "Depth.V", own + "Z", "Z", "depth.Z",
                           "Depth.Z", "Depth.V", "depth.V", "depth.z", "z"});
}

void find_depth(const ForeignFile& file, const ForeignChoice& choice, ForeignChannels& out) {
    const ForeignPart& own = file.parts()[out.part];
    out.depth_part = out.part;
    if (!choice.depth_channel.empty()) {
        if (own.has(choice.depth_channel)) {
            out.z = choice.depth_channel;
            return;
        }
    } else {
        out.z = depth_of(own, out.layer);
    }
    for (std::size_t i = 0; out.z.empty() && !own.deep && i < file.parts().size(); ++i) {
        const ForeignPart& part = file.parts()[i];
        if (part.deep || part.view != own.view) continue;
        out.z =
            choice.depth_channel.empty() ? depth_of(part, out.layer) : first_of(part, {choice.depth_channel});
        out.depth_part = i;
    }
    if (out.z.empty() && !choice.depth_channel.empty()) {
        fail(ExitCode::invalid_input, "{}: no channel {} (got {}; expected what --depth-channel names)",
             file.name(), choice.depth_channel, listed(own.channels));
    }
}

std::string id_of(const ForeignPart& part, const std::string& layer) {
    std::vector<std::string> names;
    for (const std::string& before : {layer, view_layer(layer), std::string()}) {
        for (const char* name :
             {"id", "ID", "Id", "objectid", "objectId", "ObjectId", "ObjectID", "object_id", "IndexOB"}) {
            for (const char* end : {"", ".X", ".V"}) names.push_back(before + name + end);
        }
    }
    return first_of(part, names);
}

void find_ids(const ForeignFile& file, const ForeignChoice& choice, ForeignChannels& out) {
    out.id_part = out.part;
    if (choice.ids == ForeignChoice::no_ids) return;
    const ForeignPart& own = file.parts()[out.part];
    std::vector<std::string> sets;
    if (!own.deep) {
        Cryptomattes found = find_cryptomattes(file, out.part);
        out.problems = std::move(found.problems);
        // Those of the same layer of a file that has several.
        const std::string layer = view_layer(out.layer);
        std::stable_partition(found.usable.begin(), found.usable.end(),
                              [&](const Cryptomatte& m) { return m.name.starts_with(layer); });
        for (Cryptomatte& set : found.usable) {
            sets.push_back(set.name);
            if (!out.matte && (choice.ids.empty() || choice.ids == set.name)) out.matte = std::move(set);
        }
    }
    // Who names what to use is not told of the others.
    const std::vector<std::string> unusable =
        choice.ids.empty() ? std::vector<std::string>() : std::exchange(out.problems, {});
    if (out.matte) return;
    const auto look = [&](const ForeignPart& part) {
        return choice.ids.empty() ? id_of(part, out.layer) : first_of(part, {choice.ids});
    };
    out.id = look(own);
    for (std::size_t i = 0; out.id.empty() && !own.deep && i < file.parts().size(); ++i) {
        if (file.parts()[i].deep || file.parts()[i].view != own.view) continue;
        out.id = look(file.parts()[i]);
        out.id_part = i;
    }
    if (out.id.empty() && !choice.ids.empty()) {
        for (const std::string& problem : unusable) {
            if (problem.starts_with("Cryptomatte " + choice.ids + " "))
                fail(ExitCode::invalid_input, "{}: {}", file.name(), problem);
        }
        sets.insert(sets.end(), own.channels.begin(), own.channels.end());
        fail(ExitCode::invalid_input, "{}: no ids {} (got {}; expected what --ids names)", file.name(),
             choice.ids, listed(sets));
    }
}

}  // namespace

std::vector<std::string> colour_layers(const ForeignPart& part) {
    std::vector<std::string> out;
    for (const std::string& name : part.channels) {
        if (name.empty() || (name.back() != 'R' && name.back() != 'r')) continue;
        std::string layer = name.substr(0, name.size() - 1);
        if (!layer.empty() && layer.back() != '.') continue;
        if (has_colours(part, layer) && std::find(out.begin(), out.end(), layer) == out.end())
            out.push_back(std::move(layer));
    }
    return out;
}

std::string listed(std::span<const std::string> names) {
    constexpr std::size_t most = 24;
    const auto shown = names.first(std::min(most, names.size()));
    return fmt::format("{}{}", fmt::join(shown, ", "),
                       names.size() > most ? fmt::format(" and {} more", names.size() - most) : "");
}

ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice) {
    ForeignChannels out;
    if (const auto best = best_colours(file, choice.layer)) {
        const ForeignPart& part = file.parts()[best->part];
        out.part = best->part;
        out.layer = best->layer;
        out.r = colour(part, out.layer, 'R');
        out.g = colour(part, out.layer, 'G');
        out.b = colour(part, out.layer, 'B');
    } else {
        // Grey, or nothing but what is covered and where.
        std::optional<std::size_t> found;
        for (std::size_t i = 0; i < file.parts().size() && !found; ++i) {
            const ForeignPart& part = file.parts()[i];
            if (is_asked(part, "", choice.layer) && (part.has("Y") || (part.has("A") && part.has("Z"))))
                found = i;
        }
        if (!found) {
            std::vector<std::string> names;
            for (const ForeignPart& part : file.parts())
                names.insert(names.end(), part.channels.begin(), part.channels.end());
            fail(ExitCode::invalid_input, "{}: no colours{} (got channels {}; expected R, G and B)",
                 file.name(), choice.layer.empty() ? "" : " in " + choice.layer, listed(names));
        }
        out.part = *found;
        const std::string grey = first_of(file.parts()[*found], {"Y"});
        out.r = grey;
        out.g = grey;
        out.b = grey;
    }
    const ForeignPart& part = file.parts()[out.part];
    out.a = colour(part, out.layer, 'A');
    // A small a beside R, G, B is somebody's own channel.
    if (out.a.ends_with('a') && !out.r.ends_with('r')) out.a.clear();
    find_depth(file, choice, out);
    if (part.deep) {
        out.z_back = first_of(part, {out.layer + "ZBack", "ZBack"});
        if (out.z.empty()) {
            fail(ExitCode::invalid_input, "{}: no depth (got channels {}; expected Z in a deep picture)",
                 file.name(), listed(part.channels));
        }
    }
    find_ids(file, choice, out);
    return out;
}

}  // namespace postlens
