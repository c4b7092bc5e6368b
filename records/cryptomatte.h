// Cryptomatte: which surfaces a pixel shows, and what share of it each has.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "records/channel_groups.h"
#include "records/foreign_file.h"

namespace postlens {

/// Two channels: the id as the bits of a float, and the share of the pixel that it has, 0 to 1.
struct MatteRank {
    std::size_t part = 0;
    std::string id, coverage;
};

/// A set of mattes (specification 1.2): ranks by falling share.
struct Cryptomatte {
    std::string name;  ///< what the channels' names begin with, before the two digits
    std::vector<MatteRank> ranks;
    std::string manifest;  ///< names of the ids as JSON, as the file has it; empty: none
};

struct Cryptomattes {
    std::vector<Cryptomatte> usable;
    std::vector<std::string> problems;  ///< a line for each that cannot be used
};

/// Those whose channels lie in `part` or in other flat parts of its view, or in the file given for ids: of
/// every `cryptomatte/KEY/name` attribute, and those that are named so (a name with "rypto", NAME00.R)
/// without one. Ranks are taken while both of their channels are there; ids that are no 32 bits any more
/// (half floats, lossy compression) make a set unusable. Sets of objects stand first, then assets, then the
/// others by name.
[[nodiscard]] Cryptomattes find_cryptomattes(const ForeignFile& file, std::size_t part);

/// Whose the mattes of a usable set are, by its name and that of its first part.
[[nodiscard]] ChannelGroup cryptomatte_group(const ForeignFile& file, const Cryptomatte& set);

/// How many names a manifest has; -1 where it is none: no JSON object of names with eight hexadecimal digits.
[[nodiscard]] int manifest_names(const std::string& manifest);

/// The id of a name, as the specification has it: MurmurHash3 (x86, 32 bits, seed 0), with the lowest bit of
/// the exponent turned over where the float would be none.
[[nodiscard]] std::uint32_t cryptomatte_id(std::string_view name);

}  // namespace postlens
