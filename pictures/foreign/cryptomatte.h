// Cryptomatte channels: the ids of the surfaces that a pixel shows, and their coverages.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/channel_groups.h"
#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// One rank of a Cryptomatte. It has two channels: an id, stored as the bits of a float, and the share of the
/// pixel that the id covers, 0 to 1.
struct MatteRank {
    std::size_t part = 0;
    std::string id, coverage;
};

/// One Cryptomatte (specification 1.2): ranks in order of decreasing coverage.
struct Cryptomatte {
    std::string name;  ///< prefix of the channel names, before the two digits
    std::vector<MatteRank> ranks;
    std::string manifest;  ///< names of the ids as JSON, as stored in the file; empty: none
};

struct Cryptomattes {
    std::vector<Cryptomatte> usable;
    std::vector<std::string> problems;  ///< one line for each Cryptomatte that is not usable
};

/// Finds the Cryptomattes whose channels are in `part`, in other flat parts of its view, or in a separate
/// file of ids: those named by `cryptomatte/KEY/name` attributes, and those without attribute whose channels
/// have names of the form NAME00.R with "rypto" in NAME. Ranks are used up to the first with a missing
/// channel. Ids stored with fewer than 32 bits (half floats, lossy compression) make a Cryptomatte unusable.
/// Sorted: objects, assets, then by name.
[[nodiscard]] Cryptomattes find_cryptomattes(const ForeignFile& file, std::size_t part);

/// View and layer of a usable Cryptomatte, from its name and that of its first part.
[[nodiscard]] ChannelGroup cryptomatte_group(const ForeignFile& file, const Cryptomatte& set);

/// The names in a manifest; none if it is not a JSON object of names with up to eight hexadecimal digits.
[[nodiscard]] std::optional<std::vector<std::string>> manifest_names(const std::string& manifest);

/// Id of a name by the specification: MurmurHash3 (x86, 32 bits, seed 0), with the lowest bit of the exponent
/// flipped if the float would otherwise be denormal, infinite or NaN.
[[nodiscard]] std::uint32_t cryptomatte_id(std::string_view name);

}  // namespace postlens
