// Which channels of another program's OpenEXR file hold colour, alpha, depth and ids.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "records/channel_groups.h"
#include "records/cryptomatte.h"
#include "records/depth_encoding.h"
#include "records/foreign_file.h"

namespace postlens {

/// Names of channels; absent ones are empty.
struct ForeignChannels {
    std::size_t part = 0;  ///< of the colours
    std::string layer;     ///< what the names of colours begin with, its dot included; empty: nothing
    std::string r, g, b;
    std::string ry, by;  ///< chroma, where r, g and b are all the luminance: (R - Y) / Y and (B - Y) / Y
    std::size_t alpha_part = 0;
    std::string a;
    std::size_t depth_part = 0;
    std::string z, z_back;  ///< `z_back`: of deep parts, called like `z`
    std::size_t id_part = 0;
    std::string id;                     ///< of deep parts in the part of the colours; empty with `matte`
    std::optional<Cryptomatte> matte;   ///< of flat parts
    std::vector<std::string> problems;  ///< about ids: a line for each that are there and cannot be used
    std::vector<std::string> assumed;   ///< a line for each channel that is surmised or is left aside
};

struct ForeignChoice {
    std::string layer;          ///< a part, a view, or what names of channels begin with; empty: found
    std::string depth_channel;  ///< empty: found by its name
    std::string ids;            ///< a channel or a Cryptomatte; `no_ids`: none; empty: found by its name
    std::optional<DepthEncoding> depth_encoding;  ///< absent: distances, and warned where they look otherwise
    std::filesystem::path depth_file, ids_file;   ///< where these passes have files of their own; else empty
    static constexpr const char* no_ids = "none";
    [[nodiscard]] bool given() const {
        return !layer.empty() || !depth_channel.empty() || !ids.empty() || depth_encoding ||
               !depth_file.empty() || !ids_file.empty();
    }
};

/// Opens a picture and the files of its passes.
[[nodiscard]] ForeignFile open_foreign_file(const std::filesystem::path& path, const ForeignChoice& choice);

/// Of the parts and layers that `choice.layer` allows (all where it is empty; a part by its name, a view by
/// its name, a layer by what stands before the dot, else any whose names have all of its words), the first
/// of: R, G, B; LAYER.Combined.R, .G, .B (Blender); rgba., beauty. or color. likewise; any layer with R, G,
/// B; Y, with RY and BY where they are (grey without both); A with Z alone (black); of equals, one that has a
/// depth. Colours may be small letters or whole words. Everything else is the one that goes with them
/// (match_group, for flat parts in any part, for deep ones in theirs): alpha A or alpha; depth Z, or V, Y or
/// R of a pass named depth or the like; ids, by which surfaces are told apart, of a flat part a Cryptomatte
/// (find_cryptomattes), which knows what edges are mixed of, else id, ID, objectid, object_id or IndexOB,
/// each alone or followed by .X or .V. Where a pass has a file of its own it is looked for there alone. What
/// is surmised, and what is not taken as it belongs to another view or layer, is said (`assumed`,
/// `problems`). Throws Error(invalid_input) where nothing fits, and names what there is.
[[nodiscard]] ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice);

/// Whose the colours of the file are: a group for each layer that has some.
[[nodiscard]] std::vector<ChannelGroup> colour_groups(const ForeignFile& file);

/// The layers of a part that have colours, with their dots; the empty text for R, G, B without one.
[[nodiscard]] std::vector<std::string> colour_layers(const ForeignPart& part);

/// Names, in a line of bearable length.
[[nodiscard]] std::string listed(std::span<const std::string> names);

}  // namespace postlens
