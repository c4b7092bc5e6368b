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

/// Names of the channels to read. The name of an absent channel is empty.
struct ForeignChannels {
    std::size_t part = 0;  ///< part with the colours
    std::string layer;     ///< prefix of the colours' names, with its dot; may be empty
    std::string r, g, b;
    std::string ry, by;  ///< chroma (R - Y) / Y, (B - Y) / Y; r, g and b then name Y
    std::size_t alpha_part = 0;
    std::string a;
    std::size_t depth_part = 0;
    std::string z, z_back;  ///< `z_back`: only deep parts, same layer as `z`
    std::size_t id_part = 0;
    std::string id;                     ///< for deep parts, in the part of the colours; empty with `matte`
    std::optional<Cryptomatte> matte;   ///< of flat parts
    std::vector<std::string> problems;  ///< one line for each id channel or Cryptomatte that is not usable
    std::vector<std::string> assumed;   ///< one line for each channel that is uncertain or not used
};

struct ForeignChoice {
    std::string layer;          ///< a part, a view, or a prefix of channel names; empty: automatic
    std::string depth_channel;  ///< empty: automatic, by name
    std::string ids;            ///< a channel or a Cryptomatte; `no_ids`: none; empty: automatic, by name
    std::optional<DepthEncoding> depth_encoding;  ///< absent: distances, with a warning if implausible
    std::filesystem::path depth_file, ids_file;   ///< separate files of these passes; empty: none
    static constexpr const char* no_ids = "none";
    [[nodiscard]] bool given() const {
        return !layer.empty() || !depth_channel.empty() || !ids.empty() || depth_encoding ||
               !depth_file.empty() || !ids_file.empty();
    }
};

/// Opens an image together with the separate files of its passes.
[[nodiscard]] ForeignFile open_foreign_file(const std::filesystem::path& path, const ForeignChoice& choice);

/// Finds the channels of an image.
///
/// Colours are searched in the layers that `choice.layer` allows. It may be the name of a part, a view, or a
/// layer (the text in front of the dot). Any other text allows layers whose names contain all of its words;
/// an empty text allows all layers. The first of the following that exists is selected: R, G, B;
/// LAYER.Combined.R, .G, .B (Blender); the same with rgba, beauty or color; any layer with R, G, B; Y, with
/// RY and BY if both exist (else grey); A with Z alone (black). If several layers are equal in this order,
/// one with depth is preferred. Names of colours may be in lower case or whole words ("red").
///
/// All other channels must belong to the colours (match_group). In flat images they may be in any part; in
/// deep images, in the part of the colours. Alpha is A or alpha. Depth is Z, or V, Y or R of a pass named
/// depth or similar. Ids distinguish surfaces. In a flat image the ids are those of a Cryptomatte
/// (find_cryptomattes), which also describes mixed edge pixels. Otherwise ids are id, ID, objectid, object_id
/// or IndexOB, alone or followed by .X or .V. If a pass has a separate file, only that file is searched.
/// `assumed` and `problems` name channels that are uncertain, and channels that are not used because they
/// belong to another view or layer.
///
/// Throws Error(invalid_input), which lists the channels of the file, if no layer has colours.
[[nodiscard]] ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice);

/// View and layer of all colours in the file.
[[nodiscard]] std::vector<ChannelGroup> colour_groups(const ForeignFile& file);

/// Layers of a part that have colours, with their dots. An empty text means R, G, B without a layer.
[[nodiscard]] std::vector<std::string> colour_layers(const ForeignPart& part);

/// Formats names as a list for an error message, in one line of limited length.
[[nodiscard]] std::string listed(std::span<const std::string> names);

}  // namespace postlens
