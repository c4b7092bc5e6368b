// Finds the motion vectors in another program's image.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "pictures/foreign/channel_groups.h"

namespace postlens {

struct VectorChoice {
    /// Names of the motion vector channels. If absent, well-known names are searched for.
    std::optional<std::pair<std::string, std::string>> channels;
    /// Displacement, in px to the right and down, for the value 1 in the motion vector channels. If absent,
    /// the channels' names determine it.
    std::optional<glm::dvec2> scale;
    std::optional<glm::dvec2> offset;  ///< value of pixels that do not move; 0 if absent
    std::filesystem::path file;        ///< separate file with the vectors, if not empty
};

/// The two channels of the motion vectors, in one part of the file. The displacement to the next frame is
/// (value - offset) * scale, in px right and down.
struct VectorChannels {
    std::size_t part = 0;
    std::string u, v;
    glm::dvec2 scale{1, 1}, offset{0, 0};
    std::string assumed;  ///< assumption about the layer or unit of the vectors; empty if nothing is assumed
};

/// Finds the vectors that belong to the colours of the group `own`. If the layer does not determine them, the
/// first of these passes is used (docs/motion_vectors.md):
/// - forward, with .u and .v, where v points upwards.
/// - Vector, with .Z and .W: minus the displacement to the next frame, where W points upwards.
/// - motion, or a name that ends with motionvector, motionvectors or velocity, with .x and .y, .X and .Y, .u
///   and .v, .U and .V, or .R and .G. Unless these are .x and .y, `assumed` says so.
///
/// A separate file may name the pass as it likes. If nothing matches, the result is empty, and `other` is the
/// group of the file's vectors. Throws Error(invalid_input) if requested channels are missing.
[[nodiscard]] std::optional<VectorChannels> find_vector_channels(const ForeignFile& file,
                                                                 const ChannelGroup& own,
                                                                 const VectorChoice& choice,
                                                                 std::optional<ChannelGroup>& other);

}  // namespace postlens
