// Which channels of a picture of another program hold its motion vectors.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct VectorChoice {
    std::optional<std::pair<std::string, std::string>> channels;  ///< absent: found by well-known names
    std::optional<glm::dvec2> scale;  ///< px to the right and px down that 1 stands for; absent: by the names
    std::string ids;                  ///< as ForeignChoice::ids
};

/// Names of channels.
struct VectorChannels {
    std::string u, v;
    glm::dvec2 scale{1, 1};  ///< px to the right and px down, in the time from this frame to the next
    std::string layer;       ///< what the names begin with, where they belong to a layer's passes; else empty
};

/// `hero_view`: whose colours have names without a view in a stereo file; empty: none is named. The names
/// looked for, in this order (docs/motion_vectors.md says what each is taken to mean):
///   forward.u/.v and forward.VIEW.u/.v, of the hero view where there is one: v upwards
///   [LAYER.]Vector.Z/.W: minus the way to the next frame, W upwards
///   motion.x/.y, velocity.x/.y: as `scale` 1,1
/// Throws Error(invalid_input) where vectors are missing, and names what there is; `source` begins the
/// message.
[[nodiscard]] VectorChannels find_vector_channels(const std::vector<std::string>& names,
                                                  const std::string& hero_view, const VectorChoice& choice,
                                                  const std::string& source);

}  // namespace postlens
