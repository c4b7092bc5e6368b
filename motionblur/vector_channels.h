// Which channels of a picture of another program hold its motion vectors.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "records/channel_groups.h"

namespace postlens {

struct VectorChoice {
    std::optional<std::pair<std::string, std::string>> channels;  ///< absent: found by well-known names
    std::optional<glm::dvec2> scale;  ///< px to the right and px down that 1 stands for; absent: by the names
    std::optional<glm::dvec2> offset;  ///< of what stands still; absent: 0
    std::filesystem::path file;        ///< where the vectors have a file of their own; else empty
};

/// Names of channels, both in one part. The way from this frame to the next, px to the right and down, is
/// (value - offset) scale.
struct VectorChannels {
    std::size_t part = 0;
    std::string u, v;
    glm::dvec2 scale{1, 1}, offset{0, 0};
    std::string assumed;  ///< what is surmised about whose they are; empty: nothing
};

/// Those that go with colours of the group `own` (match_group), of these, in this order where the layer
/// decides nothing (docs/motion_vectors.md says what each is taken to mean):
///   a pass forward, with .u and .v: v upwards
///   a pass Vector, with .Z and .W: minus the way to the next frame, W upwards
///   a pass motion, a pass velocity, with .x and .y: as `scale` 1,1
/// In a file of their own also any x and y, u and v, or R and G. Absent where there are none of these;
/// `other` then says whose they are that there are. Throws Error(invalid_input) where channels that are asked
/// for are missing.
[[nodiscard]] std::optional<VectorChannels> find_vector_channels(const ForeignFile& file,
                                                                 const ChannelGroup& own,
                                                                 const VectorChoice& choice,
                                                                 std::optional<ChannelGroup>& other);

}  // namespace postlens
