// Finds the channels of another program's OpenEXR file that hold colour, alpha, depth and ids.
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

/// Names of channels; absent ones are empty.
struct ForeignChannels {
    std::size_t part = 0;  ///< of the colours
    std::string layer;     ///< prefix of the names of colours, including its dot; may be empty
    std::string r, g, b;
    std::string ry, by;  ///< chroma (R - Y) / Y and (B - Y) / Y, if r, g and b are all the luminance
    std::size_t alpha_part = 0;
    std::string a;
    std::size_t depth_part = 0;
    std::string z, z_back;  ///< `z_back`: only deep parts, same layer as `z`
    std::size_t id_part = 0;
    std::string id;                     ///< for deep parts, in the part of the colours; empty with `matte`
    std::optional<Cryptomatte> matte;   ///< of flat parts
    std::vector<std::string> problems;  ///< one line for each id channel or Cryptomatte that is not usable
    std::vector<std::string> assumed;   ///< one line for each channel that is uncertain or is not used
};

struct ForeignChoice {
    std::string layer;          ///< a part, a view, or a prefix of channel names; empty: automatic
    std::string depth_channel;  ///< empty: automatic, by name
    std::string ids;            ///< a channel or a Cryptomatte; `no_ids`: none; empty: automatic, by name
    std::optional<DepthEncoding> depth_encoding;  ///< absent: distances, with a warning if implausible
    std::filesystem::path depth_file, ids_file;   ///< separate files of these passes; else empty
    static constexpr const char* no_ids = "none";
    [[nodiscard]] bool given() const {
        return !layer.empty() || !depth_channel.empty() || !ids.empty() || depth_encoding ||
               !depth_file.empty() || !ids_file.empty();
    }
};

/// Opens an image and the separate files of its passes.
[[nodiscard]] ForeignFile open_foreign_file(const std::filesystem::path& path, const ForeignChoice& choice);

/// Finds the channels of an image.
///
/// Colours are searched in the parts and layers that `choice.layer` allows. It names a part, a view, or a
/// layer by the text before the dot; else it allows any layer whose names have all of its words. An empty
/// text allows all. The first of these is taken: R, G, B; LAYER.Combined.R, .G, .B (Blender); the same with
/// rgba, beauty or color; any layer with R, G, B; Y, with RY and BY if both exist (else grey); A with Z alone
/// (black). Among equals, a layer with depth is preferred. Colour names may be lower case or whole words.
///
/// All other channels are those that belong to the colours (match_group). They may be in any part for flat
/// images, and are in the part of the colours for deep images. Alpha is A or alpha. Depth is Z, or V, Y or R
/// of a pass named depth or similar. Ids distinguish surfaces. In a flat image they are a Cryptomatte
/// (find_cryptomattes), which also states how edge pixels are mixed. Otherwise they are id, ID, objectid,
/// object_id or IndexOB, each alone or followed by .X or .V. If a pass has its own file, only that file is
/// searched. `assumed` and `problems` name channels that are uncertain, or that are not used because they
/// belong to another view or layer.
///
/// Throws Error(invalid_input), listing the channels of the file, if nothing fits.
[[nodiscard]] ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice);

/// Groups of all layers in the file that have colours.
[[nodiscard]] std::vector<ChannelGroup> colour_groups(const ForeignFile& file);

/// Layers of a part that have colours, including their dots; an empty text for R, G, B without a layer.
[[nodiscard]] std::vector<std::string> colour_layers(const ForeignPart& part);

/// Lists names for a message, in a line of limited length.
[[nodiscard]] std::string listed(std::span<const std::string> names);

}  // namespace postlens
