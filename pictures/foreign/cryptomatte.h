// Cryptomatte channels: the ids of the surfaces that a pixel shows, and how much of the pixel each id covers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/channel_groups.h"
#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// One rank of a Cryptomatte: one of the several surfaces that a pixel can show. A rank has two channels: an
/// id, stored as the bits of a float, and the share of the pixel that the id covers, 0 to 1.
struct MatteRank {
    std::size_t part = 0;
    std::string id, coverage;
};

/// One Cryptomatte (specification 1.2). Its ranks are in order of decreasing coverage.
struct Cryptomatte {
    std::string name;  ///< prefix of the channel names, before the two digits
    std::vector<MatteRank> ranks;
    std::string manifest;  ///< names of the ids as JSON, as in the file; empty: none
};

struct Cryptomattes {
    std::vector<Cryptomatte> usable;
    std::vector<std::string> problems;  ///< one line for each Cryptomatte that is not usable
};

/// Finds the Cryptomattes whose channels are in `part`, in other flat parts of the same view, or in a
/// separate file of ids. A Cryptomatte is named by a `cryptomatte/KEY/name` attribute, or, without the
/// attribute, by channels NAME00.R with "rypto" in NAME. Ranks after the first missing channel are ignored. A
/// Cryptomatte is unusable if its ids have fewer than 32 bits (half floats, lossy compression). The result is
/// sorted: objects, assets, others; then by name.
[[nodiscard]] Cryptomattes find_cryptomattes(const ForeignFile& file, std::size_t part);

/// View and layer of a usable Cryptomatte, from its own name and the name of its first part.
[[nodiscard]] ChannelGroup cryptomatte_group(const ForeignFile& file, const Cryptomatte& set);

/// An object that a manifest lists.
struct ManifestObject {
    std::string name;
    std::uint32_t id = 0;
};

/// Returns the objects in a manifest, sorted by name. Empty unless the manifest is a JSON object of names
/// with up to eight hexadecimal digits each.
[[nodiscard]] std::optional<std::vector<ManifestObject>> manifest_objects(const std::string& manifest);
/// Returns the names of these objects.
[[nodiscard]] std::optional<std::vector<std::string>> manifest_names(const std::string& manifest);

/// Computes the id of a name as the specification states: MurmurHash3 (x86, 32 bits, seed 0). If the hash,
/// read as a float, would be denormal, infinite or NaN, the lowest bit of its exponent is flipped.
[[nodiscard]] std::uint32_t cryptomatte_id(std::string_view name);

}  // namespace postlens
