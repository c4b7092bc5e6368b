#include "pictures/foreign/cryptomatte.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/json_dump.h"

namespace postlens {
namespace {

/// Largest number of channel groups that are read from one Cryptomatte. Each group describes two surfaces for
/// each pixel, and the groups are sorted by coverage. Any surface after the first 32 covers too little of the
/// pixel to matter.
constexpr int most_layers = 16;
constexpr std::size_t most_sets = 64;
/// Names in messages are cut to this length.
constexpr std::size_t longest_shown = 80;

/// Largest length of a channel name in OpenEXR.
constexpr std::size_t longest_name = 255;

/// Prepares a name from a file for an error message: limits its length and replaces control characters.
std::string shown(const std::string& name) {
    std::string out = name.size() <= longest_shown ? name : name.substr(0, longest_shown) + "...";
    std::replace_if(
        out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, '?');
    return out;
}

/// Returns true if the file part `part` may contain Cryptomattes (sets of object masks) for the image whose
/// colours are in the part `own`. If the user gave a separate file for object ids, only its parts may.
/// Otherwise, the parts with the same stereo view as the colours may.
bool may_hold(const ForeignFile& file, std::size_t own, std::size_t part) {
    const ForeignPart& p = file.parts()[part];
    if (p.deep) return false;
    if (file.has_own_file(PartUse::ids)) return p.use == PartUse::ids;
    return p.use == PartUse::picture && p.view == file.parts()[own].view;
}

/// Returns the index of a file part that has the channel `channel` of a Cryptomatte. The part with the
/// colours, `own`, is preferred to all other parts. Returns empty if no part has this channel.
std::optional<std::size_t> part_with(const ForeignFile& file, std::size_t own, const std::string& channel) {
    const auto parts = file.parts();
    if (may_hold(file, own, own) && parts[own].has(channel)) return own;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (may_hold(file, own, i) && parts[i].has(channel)) return i;
    }
    return std::nullopt;
}

struct Letter {
    std::array<const char*, 3> names;
};
constexpr Letter red{{"R", "r", "red"}}, green{{"G", "g", "green"}}, blue{{"B", "b", "blue"}},
    alpha_name{{"A", "a", "alpha"}};

std::optional<MatteRank> rank_of(const ForeignFile& file, std::size_t own, const std::string& layer,
                                 const Letter& id, const Letter& coverage) {
    for (std::size_t i = 0; i < id.names.size(); ++i) {
        MatteRank rank{own, layer + id.names[i], layer + coverage.names[i]};
        const auto part = part_with(file, own, rank.id);
        if (!part || !file.parts()[*part].has(rank.coverage)) continue;
        rank.part = *part;
        return rank;
    }
    return std::nullopt;
}

std::vector<MatteRank> ranks_of(const ForeignFile& file, std::size_t own, const std::string& name) {
    std::vector<MatteRank> out;
    if (name.size() > longest_name) return out;
    for (int i = 0; i < most_layers; ++i) {
        const std::string layer = fmt::format("{}{:02}.", name, i);
        for (const auto& [id, coverage] : {std::pair(&red, &green), std::pair(&blue, &alpha_name)}) {
            const auto rank = rank_of(file, own, layer, *id, *coverage);
            if (!rank) return out;
            out.push_back(*rank);
        }
    }
    return out;
}

/// Finds Cryptomattes by their channels, for files without metadata. A channel NAME00.R belongs to the
/// Cryptomatte NAME if NAME contains Crypto or crypto.
std::vector<std::string> named_so(const ForeignFile& file, std::size_t own) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        if (!may_hold(file, own, i)) continue;
        for (const std::string& channel : file.parts()[i].channels) {
            for (const char* letter : red.names) {
                const std::string end = std::string("00.") + letter;
                if (channel.ends_with(end) && channel.find("rypto") != std::string::npos)
                    out.push_back(channel.substr(0, channel.size() - end.size()));
            }
        }
    }
    return out;
}

/// Returns the sort key of a Cryptomatte with this name: 0 for objects, 1 for assets (groups of objects), 2
/// for others.
int kind(const std::string& name) {
    const auto has = [&](const char* upper, const char* lower) {
        return name.find(upper) != std::string::npos || name.find(lower) != std::string::npos;
    };
    return has("Object", "object") ? 0 : has("Asset", "asset") ? 1 : 2;
}

std::string why_not(const ForeignFile& file, const Cryptomatte& set) {
    if (set.ranks.empty()) return fmt::format("no channels {0}00.R and {0}00.G", shown(set.name));
    for (const MatteRank& rank : set.ranks) {
        if (file.kind(rank.part, rank.id) != ChannelKind::float32)
            return fmt::format("channel {} does not have 32 bits", shown(rank.id));
        if (file.loses_bits(rank.part)) return "the file's compression has changed its ids";
    }
    return "";
}

/// Separators in a manifest, a JSON object of the form {"name":"id","name":"id"}.
constexpr std::string_view before_id = R"(":")", before_name = R"(",")";
/// Number of digits in the ids of Cycles.
constexpr std::size_t id_digits = 8;

/// Returns the end of an object's name in a Cryptomatte manifest, or npos. The name begins at the index
/// `begin`. It may contain quotation marks, so it ends only where `before_id` (the characters between name
/// and id) and a valid id follow.
std::size_t end_of_name(const std::string& manifest, std::size_t begin) {
    for (std::size_t at = manifest.find(before_id, begin); at != std::string::npos;
         at = manifest.find(before_id, at + 1)) {
        const std::size_t id = at + before_id.size(), end = id + id_digits;
        if (manifest.find_first_not_of("0123456789abcdef", id) != end) continue;
        const std::string_view rest = std::string_view(manifest).substr(end);
        if (rest.starts_with(before_name) || rest == "\"}") return at;
    }
    return std::string::npos;
}

/// Reads a Cryptomatte manifest (a list of object names and ids) in which quotation marks and backslashes of
/// names are not escaped. So end_of_name() finds the end of each name by the id that must follow it. Returns
/// empty if this fails.
std::optional<nlohmann::json> unescaped_manifest(const std::string& manifest) {
    if (!manifest.starts_with("{\"")) return std::nullopt;
    auto objects = nlohmann::json::object();
    for (std::size_t name = 2;;) {
        const std::size_t end = end_of_name(manifest, name);
        if (end == std::string::npos) return std::nullopt;
        const std::size_t id = end + before_id.size();
        objects[manifest.substr(name, end - name)] = manifest.substr(id, id_digits);
        name = id + id_digits + before_name.size();
        if (name > manifest.size()) return objects;
    }
}

/// Returns true if the id of every object name in a Cryptomatte manifest is the hash of the name.
bool has_its_ids(const nlohmann::json& manifest) {
    if (!manifest.is_object()) return false;
    const auto items = manifest.items();
    return std::all_of(items.begin(), items.end(), [](const auto& item) {
        return item.value() == fmt::format("{:0{}x}", cryptomatte_id(item.key()), id_digits);
    });
}

/// Returns a Cryptomatte manifest (object names and ids) as valid JSON. The renderer Cycles does not escape
/// quotation marks and backslashes.
std::string as_json(std::string manifest) {
    const auto parsed = nlohmann::json::parse(manifest, nullptr, false);
    const bool valid = !parsed.is_discarded();
    if (valid && (manifest.find('\\') == std::string::npos || has_its_ids(parsed))) return manifest;
    const auto unescaped = unescaped_manifest(manifest);
    if (!unescaped || (valid && !has_its_ids(*unescaped))) return manifest;
    return json_dump(*unescaped);
}

/// Largest size of a manifest file that is read.
constexpr std::uintmax_t most_manifest_bytes = 64U << 20U;

/// Returns the text of a manifest, the list of object names and ids of a Cryptomatte, or empty if it cannot
/// be read. Cryptomatte requires that its file, `name`, is in the folder of the image `image`, so a name with
/// a folder is rejected.
std::string text_beside(const std::string& image, const std::string& name) {
    namespace fs = std::filesystem;
    if (fs::path(name).filename() != fs::path(name)) return "";
    try {
        return read_text_file(fs::path(image).parent_path() / name, most_manifest_bytes);
    } catch (const Error&) {
        return "";
    }
}

}  // namespace

Cryptomattes find_cryptomattes(const ForeignFile& file, std::size_t part) {
    struct Said {
        std::string name, manifest, manifest_file;
        std::size_t part = 0;
    };
    std::map<std::string, Said> keys;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        if (!may_hold(file, part, i)) continue;
        for (const char* prefix : {"cryptomatte/", "exr/cryptomatte/"}) {
            for (auto& [name, text] : file.texts(i, prefix)) {
                const std::string rest = name.substr(std::string(prefix).size());
                const std::size_t slash = rest.find('/');
                if (slash == std::string::npos) continue;
                Said& said = keys[rest.substr(0, slash)];
                const std::string what = rest.substr(slash + 1);
                if (what == "name") {
                    said.name = std::move(text);
                } else if (what == "manifest") {
                    said.manifest = as_json(std::move(text));
                } else if (what == "manif_file") {
                    said.manifest_file = std::move(text);
                    said.part = i;
                }
            }
        }
    }
    std::map<std::string, Cryptomatte> sets;
    Cryptomattes out;
    for (auto& [key, said] : keys) {
        if (said.name.empty()) {
            out.problems.push_back(fmt::format("Cryptomatte {} has no name", shown(key)));
        } else {
            if (said.manifest.empty() && !said.manifest_file.empty()) {
                said.manifest = as_json(text_beside(file.name_of(said.part), said.manifest_file));
                if (said.manifest.empty()) {
                    out.problems.push_back(fmt::format(
                        "Cryptomatte {} has no names of objects: cannot read its manifest {} beside {}",
                        shown(said.name), shown(said.manifest_file), file.name_of(said.part)));
                }
            }
            sets[said.name] = {said.name, {}, std::move(said.manifest)};
        }
    }
    for (const std::string& name : named_so(file, part)) sets.try_emplace(name, Cryptomatte{name, {}, ""});
    for (auto& [name, set] : sets) {
        if (out.usable.size() + out.problems.size() >= most_sets) break;
        set.ranks = ranks_of(file, part, name);
        const std::string why = why_not(file, set);
        if (why.empty()) {
            out.usable.push_back(std::move(set));
        } else {
            out.problems.push_back(fmt::format("Cryptomatte {} is not used: {}", shown(name), why));
        }
    }
    std::stable_sort(out.usable.begin(), out.usable.end(),
                     [](const Cryptomatte& a, const Cryptomatte& b) { return kind(a.name) < kind(b.name); });
    return out;
}

ChannelGroup cryptomatte_group(const ForeignFile& file, const Cryptomatte& set) {
    ChannelGroup out = channel_group(file, set.ranks.at(0).part, set.name, id_words);
    std::erase_if(out.layer, [](const std::string& word) {
        return word.starts_with("crypto") || word.starts_with("ucrypto") || word == "asset" ||
               word == "material";
    });
    return out;
}

std::optional<std::vector<ManifestObject>> manifest_objects(const std::string& manifest) {
    // The argument `false` makes the parser return errors without exceptions. It is not recursive, so deeply
    // nested JSON cannot overflow the call stack.
    const auto json = nlohmann::json::parse(manifest, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    std::vector<ManifestObject> objects;
    for (const auto& [name, id] : json.items()) {
        if (!id.is_string()) return std::nullopt;
        const auto& digits = id.get_ref<const std::string&>();
        if (digits.empty() || digits.size() > 8 ||
            digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
            return std::nullopt;
        objects.push_back({name, static_cast<std::uint32_t>(std::stoul(digits, nullptr, 16))});
    }
    return objects;
}

std::optional<std::vector<std::string>> manifest_names(const std::string& manifest) {
    const auto objects = manifest_objects(manifest);
    if (!objects) return std::nullopt;
    std::vector<std::string> names;
    for (const ManifestObject& o : *objects) names.push_back(o.name);
    return names;
}

std::uint32_t cryptomatte_id(std::string_view name) {
    constexpr std::uint32_t c1 = 0xcc9e2d51U, c2 = 0x1b873593U;
    std::uint32_t hash = 0;
    const auto scrambled = [](std::uint32_t k) { return std::rotl(k * c1, 15) * c2; };
    const auto byte = [&](std::size_t i) {
        return static_cast<std::uint32_t>(static_cast<unsigned char>(name[i]));
    };
    std::size_t i = 0;
    for (; i + 4 <= name.size(); i += 4) {
        const std::uint32_t k = byte(i) | byte(i + 1) << 8U | byte(i + 2) << 16U | byte(i + 3) << 24U;
        hash = std::rotl(hash ^ scrambled(k), 13) * 5 + 0xe6546b64U;
    }
    std::uint32_t tail = 0;
    for (std::size_t k = name.size(); k > i; --k) tail = tail << 8U | byte(k - 1);
    hash ^= scrambled(tail);
    hash ^= static_cast<std::uint32_t>(name.size());
    hash = (hash ^ hash >> 16U) * 0x85ebca6bU;
    hash = (hash ^ hash >> 13U) * 0xc2b2ae35U;
    hash ^= hash >> 16U;
    // A Cryptomatte stores the hash as the bits of a float. If the exponent bits are all 0 or all 1 (255), a
    // compositor may change the bits. To avoid such floats, the Cryptomatte specification flips the lowest
    // bit of the exponent.
    const std::uint32_t exponent = hash >> 23U & 255U;
    if (exponent == 0 || exponent == 255) hash ^= 1U << 23U;
    return hash;
}

}  // namespace postlens
