// The state of an unfinished render from which it can be resumed, and its file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "records/image.h"

namespace postlens {

/// Blocks that the samples of a pixel are divided into, at most: as many parts can be made of them.
inline constexpr int most_sample_blocks = 64;

/// Sums of radiance, with exposure, per pixel (3 doubles each, row-major), and their numbers of samples, for
/// one or two halves.
///
/// The samples of a pixel are divided into blocks. The sum of a pixel is the sum of its blocks' sums, in
/// their order, so that blocks that are rendered apart from each other add up to the same bits. A state holds
/// either all blocks, added up (`blocks` 1), or each of some blocks.
struct RenderState {
    int width = 0, height = 0, halves = 1;
    int blocks = 1;             ///< sums that are kept apart; block b begins at b * 3 * width * height
    double exposure_stops = 0;  ///< of the sums
    std::array<std::vector<double>, 2> sums;
    /// The sum of the block that has begun, with `blocks` 1; empty if no block is left unfinished by a round.
    std::array<std::vector<double>, 2> open;
    std::array<std::vector<std::uint32_t>, 2> samples;  ///< per pixel

    RenderState() = default;
    RenderState(int w, int h, int count, double stops = 0, int blocks_apart = 1, bool with_open = false);
    [[nodiscard]] static std::uint64_t bytes(int width, int height, int halves, int blocks = 1,
                                             bool with_open = false);
    /// Adds what the blocks of a further part hold, whose samples come after those of all parts before it.
    void add(const RenderState& part);
    /// The mean over all samples so far. Pixels without samples are black.
    [[nodiscard]] Image picture() const;
    [[nodiscard]] Image half(int which) const;
};

/// Writes an OpenEXR file: R, G, B hold the radiance so far, and further channels hold the exact bits of all
/// sums and counts. `settings` identifies the render; `part_mark`, if not empty, makes the file a part.
/// Throws Error(cannot_write).
void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings,
                 const std::string& part_mark = "");

/// Some of the samples of a render.
struct RenderPart {
    RenderState state;
    std::string settings, mark;  ///< as write_state got them
};

/// Reads a part that write_state has written. Empty if the file is something else. Throws
/// Error(invalid_input) for a damaged part.
[[nodiscard]] std::optional<RenderPart> read_render_part(const std::filesystem::path& path);

/// Fills `state`, whose size and halves are set, from a file of the same settings. Throws
/// Error(invalid_input) if the file was not written by write_state, is damaged or has other settings.
void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state);

}  // namespace postlens
