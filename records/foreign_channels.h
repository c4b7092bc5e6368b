// Which channels of another program's OpenEXR file hold colour, alpha, depth and ids.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "records/cryptomatte.h"
#include "records/foreign_file.h"

namespace postlens {

/// Names of channels; absent ones are empty.
struct ForeignChannels {
    std::size_t part = 0;  ///< of colour and alpha
    std::string layer;     ///< what the names of colours begin with, its dot included; empty: nothing
    std::string r, g, b, a;
    std::size_t depth_part = 0;
    std::string z, z_back;  ///< `z_back` lies in the part of the colours
    std::size_t id_part = 0;
    std::string id;                     ///< of deep parts in the part of the colours; empty with `matte`
    std::optional<Cryptomatte> matte;   ///< of flat parts
    std::vector<std::string> problems;  ///< about ids: a line for each that are there and cannot be used
};

struct ForeignChoice {
    std::string layer;          ///< a part, a view, or what names of channels begin with; empty: found
    std::string depth_channel;  ///< empty: found by its name
    std::string ids;            ///< a channel or a Cryptomatte; `no_ids`: none; empty: found by its name
    static constexpr const char* no_ids = "none";
};

/// Of the parts and layers that `choice.layer` allows (all where it is empty; a part by its name, a view by
/// its name, a layer by what stands before the dot), the first of: R, G, B; LAYER.Combined.R, .G, .B
/// (Blender); rgba., beauty. or color. likewise; any layer with R, G, B; Y alone (grey); A with Z alone
/// (black). Names of colours may be small letters. Alpha is the layer's A. Depth is the layer's Z; for
/// LAYER.Combined it is LAYER.Depth.Z, or .V; else the part's Z, depth.Z, Depth.Z, Depth.V or depth.V; else
/// the same of another flat part of that view. Ids, by which surfaces are told apart: of a
/// flat part the first Cryptomatte (find_cryptomattes), which knows what edges are mixed of; else, of the
/// layer, the part or another flat part of that view, id, ID, Id, objectid, objectId, ObjectId, ObjectID,
/// object_id or IndexOB, each alone or followed by .X or .V. Throws Error(invalid_input) where nothing fits,
/// and names what there is.
[[nodiscard]] ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice);

/// The layers of a part that have colours, with their dots; the empty text for R, G, B without one.
[[nodiscard]] std::vector<std::string> colour_layers(const ForeignPart& part);

/// Names, in a line of bearable length.
[[nodiscard]] std::string listed(std::span<const std::string> names);

}  // namespace postlens
