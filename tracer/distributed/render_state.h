// The state of an unfinished render from which it can be resumed, and its file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Largest number of blocks into which the samples of a pixel are divided, and so of parts into which a
/// render can be divided.
inline constexpr int most_sample_blocks = 64;

/// Sums of radiance, with exposure, per pixel (3 doubles each, row-major), and their numbers of samples, for
/// one or two halves.
///
/// The samples of a pixel are divided into blocks. The sum of a pixel adds the sums of its blocks in their
/// order. Blocks that are rendered separately therefore add up to the same bits. A state holds either the sum
/// over all blocks (`blocks` 1), or a separate sum for each of some blocks.
struct RenderState {
    int width = 0, height = 0, halves = 1;
    int blocks = 1;             ///< sums that are kept apart; block b begins at b * 3 * width * height
    double exposure_stops = 0;  ///< of the sums
    std::array<std::vector<double>, 2> sums;
    /// With `blocks` 1: the sum of the block that a round has begun but not finished. Empty if there is no
    /// such block.
    std::array<std::vector<double>, 2> open;
    std::array<std::vector<std::uint32_t>, 2> samples;  ///< per pixel

    RenderState() = default;
    RenderState(int w, int h, int count, double stops = 0, int blocks_apart = 1, bool with_open = false);
    [[nodiscard]] static std::uint64_t bytes(int width, int height, int halves, int blocks = 1,
                                             bool with_open = false);
    /// Adds the blocks of another part. The samples of that part must come after those of all parts added
    /// before.
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

/// Reads a part that write_state has written. Empty if the file is something else. With `facts_only`, the
/// state has its size but neither sums nor counts. Throws Error(invalid_input) for a damaged part.
[[nodiscard]] std::optional<RenderPart> read_render_part(const std::filesystem::path& path,
                                                         bool facts_only = false);

/// Fills `state`, whose size and halves are set, from a file of the same settings. Throws
/// Error(invalid_input) if the file was not written by write_state, is damaged or has other settings.
void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state);

}  // namespace postlens
