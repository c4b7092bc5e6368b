// Cryptomatte channels. They state which surfaces a pixel shows, and how much of the pixel each surface
// covers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/channel_groups.h"
#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// The two channels of a Cryptomatte that describe the surface with a certain rank in each pixel. The
/// surfaces of a pixel are ranked by the fraction of the pixel that they cover.
struct MatteRank {
    std::size_t part = 0;
    /// Names of the channels. The channel `id` holds the surface's id, as the bits of a float. The channel
    /// `coverage` holds the fraction of the pixel that the surface covers.
    std::string id, coverage;
};

/// One Cryptomatte (specification 1.2). Its ranks are sorted by decreasing coverage.
struct Cryptomatte {
    std::string name;  ///< the text before the two digits in the channel names
    std::vector<MatteRank> ranks;
    std::string manifest;  ///< names and ids as JSON, as stored in the file; may be empty
};

struct Cryptomattes {
    std::vector<Cryptomatte> usable;
    std::vector<std::string> problems;  ///< one line for each Cryptomatte that cannot be used
};

/// Finds the Cryptomattes whose channels are in `part`, in other flat parts of the same view, or in a
/// separate file of ids. A Cryptomatte is named by an attribute `cryptomatte/KEY/name`. Without this
/// attribute, it is found by a channel NAME00.R whose NAME contains Crypto or crypto. Ranks after the first
/// missing channel are ignored. A Cryptomatte cannot be used if its ids do not have all 32 bits, because they
/// are half floats or the compression is lossy. The result lists objects first, then assets, then others.
/// Within each kind it is sorted by name.
[[nodiscard]] Cryptomattes find_cryptomattes(const ForeignFile& file, std::size_t part);

/// Returns the stereo view and the layer of colours to which a Cryptomatte (a set of object masks) belongs.
/// They are derived from the Cryptomatte's name, and from the file part that contains its first channels.
[[nodiscard]] ChannelGroup cryptomatte_group(const ForeignFile& file, const Cryptomatte& set);

/// An object that a manifest lists.
struct ManifestObject {
    std::string name;
    std::uint32_t id = 0;
};

/// Returns the objects (names and ids) that a Cryptomatte's manifest lists, sorted by name. The manifest must
/// be a JSON object that maps each name to its id, a hexadecimal number of up to eight digits. Returns empty
/// if it has another form.
[[nodiscard]] std::optional<std::vector<ManifestObject>> manifest_objects(const std::string& manifest);
/// Returns the names of the objects that `manifest_objects` returns.
[[nodiscard]] std::optional<std::vector<std::string>> manifest_names(const std::string& manifest);

/// Returns the id of a name according to the specification: MurmurHash3 (x86, 32 bits, seed 0). If the hash
/// is zero, denormal, infinite or NaN as a float, the lowest bit of its exponent is flipped.
[[nodiscard]] std::uint32_t cryptomatte_id(std::string_view name);

}  // namespace postlens
