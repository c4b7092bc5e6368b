// Finds the channels for colour, alpha, depth and ids in another program's OpenEXR file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/channel_groups.h"
#include "pictures/foreign/cryptomatte.h"
#include "pictures/foreign/depth_encoding.h"
#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// Names of the channels to read. The name of a missing channel is empty.
struct ForeignChannels {
    std::size_t part = 0;  ///< part with the colours
    std::string layer;     ///< prefix of the colours' names, with its dot; may be empty
    std::string r, g, b;
    std::string ry, by;  ///< chroma (R - Y) / Y and (B - Y) / Y; r, g and b are then all Y
    std::size_t alpha_part = 0;
    std::string a;
    std::size_t depth_part = 0;
    std::string z, z_back;  ///< `z_back` is only in deep parts, in the layer of `z`
    std::size_t id_part = 0;
    std::string id;                     ///< if deep: in the part of the colours; empty if `matte` is used
    std::optional<Cryptomatte> matte;   ///< only in flat parts
    std::vector<std::string> problems;  ///< one line for each id channel or Cryptomatte that cannot be used
    std::vector<std::string> assumed;   ///< one line for each channel that is uncertain or not used
};

struct ForeignChoice {
    std::string layer;          ///< a part, a view, or a prefix of channel names; empty means automatic
    std::string depth_channel;  ///< empty means automatic, by name
    std::string ids;            ///< a channel or Cryptomatte; `no_ids`: none; empty: automatic, by name
    std::optional<DepthEncoding> depth_encoding;  ///< absent: distances, with a warning if implausible
    std::filesystem::path depth_file, ids_file;   ///< separate files of these passes; empty: none
    static constexpr const char* no_ids = "none";
    [[nodiscard]] bool given() const {
        return !layer.empty() || !depth_channel.empty() || !ids.empty() || depth_encoding ||
               !depth_file.empty() || !ids_file.empty();
    }
};

/// Opens an image and any separate files with its passes (such as depth or ids).
[[nodiscard]] ForeignFile open_foreign_file(const std::filesystem::path& path, const ForeignChoice& choice);

/// Finds the channels of an image.
///
/// Colours are searched in the layers that `choice.layer` allows. `choice.layer` can be the name of a part, a
/// view or a layer (the text before the dot). Any other text allows the layers whose names contain all of its
/// words. An empty text allows all layers. The following sources of colour are tried in this order:
/// - R, G, B without a layer,
/// - LAYER.Combined.R, .G and .B, which Blender writes,
/// - a layer with the word rgba, beauty or color,
/// - any layer with R, G, B,
/// - Y, with RY and BY if both exist (otherwise grey),
/// - A and Z alone (black).
///
/// If several layers have the same place in this list, a layer with depth is preferred. Names of colour
/// channels may also be in lower case or be whole words ("red").
///
/// The channels for alpha, depth and ids must belong to the colours (see match_group). In flat images they
/// may be in any part. In deep images they must be in the part of the colours. Alpha is A or alpha. Depth is
/// Z, or V, Y or R of a pass named depth or similar. Ids distinguish surfaces. In a flat image they come from
/// a Cryptomatte (find_cryptomattes), which also describes mixed edge pixels. Otherwise they come from a
/// channel named id, ID, objectid, object_id or IndexOB, with or without a suffix .X or .V. If there is a
/// separate file for a pass, only that file is searched.
///
/// `assumed` and `problems` list channels that are uncertain, and channels that are not used because they
/// belong to another view or layer. Throws Error(invalid_input) with a list of the file's channels if no
/// layer has colours.
[[nodiscard]] ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice);

/// Returns the view and layer of all colours in the file.
[[nodiscard]] std::vector<ChannelGroup> colour_groups(const ForeignFile& file);

/// Returns the layers that have colour channels in a part of an OpenEXR file. A layer is given by the prefix
/// of its channel names, for example "ViewLayer.Combined." for the channel ViewLayer.Combined.R. The prefix
/// is empty for channels R, G and B without a layer.
[[nodiscard]] std::vector<std::string> colour_layers(const ForeignPart& part);

/// Formats names for an error message, as one line of limited length.
[[nodiscard]] std::string listed(std::span<const std::string> names);

}  // namespace postlens
