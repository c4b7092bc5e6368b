// Finds the channels that contain the motion vectors in another program's image.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "pictures/foreign/channel_groups.h"

namespace postlens {

struct VectorChoice {
    std::optional<std::pair<std::string, std::string>> channels;  ///< absent: found by well-known names
    std::optional<glm::dvec2> scale;   ///< px to the right and down per unit; absent: follows from the names
    std::optional<glm::dvec2> offset;  ///< value of pixels that do not move; absent: 0
    std::filesystem::path file;        ///< separate file with the vectors; empty: none
};

/// Names of the two channels, which must be in one part of the file. The displacement from this frame to the
/// next, px to the right and down, is (value - offset) * scale.
struct VectorChannels {
    std::size_t part = 0;
    std::string u, v;
    glm::dvec2 scale{1, 1}, offset{0, 0};
    std::string assumed;  ///< what is assumed about the layer that they belong to; empty: nothing
};

/// Finds the vectors that belong to the colours of the group `own` (match_group). If the layer does not
/// determine them, the first of these passes is used (docs/motion_vectors.md defines them):
///   forward, with .u and .v: v points upwards
///   Vector, with .Z and .W: minus the displacement to the next frame; W points upwards
///   motion or velocity, with .x and .y: `scale` 1,1
/// In a separate file, channels x and y, u and v, or R and G with any pass name are also accepted. If nothing
/// matches, the result is empty, and `other` is the group of the vectors that the file does contain. Throws
/// Error(invalid_input) if requested channels are missing.
[[nodiscard]] std::optional<VectorChannels> find_vector_channels(const ForeignFile& file,
                                                                 const ChannelGroup& own,
                                                                 const VectorChoice& choice,
                                                                 std::optional<ChannelGroup>& other);

}  // namespace postlens
