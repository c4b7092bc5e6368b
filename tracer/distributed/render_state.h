// The state of an unfinished render, and the file from which the render resumes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Largest number of blocks into which the samples of a pixel are divided. If several runs share a render,
/// each run renders whole blocks. Therefore, N in `--share I/N --share-by samples` is not larger.
inline constexpr int most_sample_blocks = 64;

/// An unfinished render: the sums of radiance and the numbers of samples of all pixels. The samples of a
/// pixel are divided into blocks with separate sums, which are added in a fixed order. Therefore, the image
/// does not depend on which run (--share) rendered which block.
///
/// The samples may form two independent halves. The difference of their means shows the noise of the image.
struct RenderState {
    int width = 0, height = 0, halves = 1;
    int blocks = 1;             ///< number of separate sums; block b begins at b * 3 * width * height
    double exposure_stops = 0;  ///< exposure of the sums
    /// Sums of radiance times exposure over the samples of each pixel. There are 3 doubles (RGB) for each
    /// pixel, and the pixels follow row by row. If the samples form two independent halves, each half has its
    /// own array. Otherwise, the second array is empty.
    std::array<std::vector<double>, 2> sums;
    /// Sums of the current block of samples, with the layout of `sums`. They are added to `sums` when the
    /// block is complete, so that the order of additions is fixed. Empty if a block is traced at once, or if
    /// each block has its own sum in `sums`.
    std::array<std::vector<double>, 2> open;
    std::array<std::vector<std::uint32_t>, 2> samples;  ///< per pixel

    RenderState() = default;
    RenderState(int w, int h, int count, double stops = 0, int blocks_apart = 1, bool with_open = false);
    [[nodiscard]] static std::uint64_t bytes(int width, int height, int halves, int blocks = 1,
                                             bool with_open = false);
    /// Adds the samples of another part of the same render.
    /// Parts must be added in order, because sums of doubles depend on the order of addition.
    void add(const RenderState& part);
    /// Returns the mean radiance of all samples so far. Pixels without samples are black.
    [[nodiscard]] Image picture() const;
    [[nodiscard]] Image half(int which) const;
};

/// Writes an unfinished render to an OpenEXR file: the mean radiance so far, and all sums and counts exactly.
/// `settings` identifies the render. `part_mark` is not empty if the file is a part of a render (--share).
/// Throws Error(cannot_write).
void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings,
                 const std::string& part_mark = "");

/// Some of the samples of every pixel, rendered by one of several program runs (--share).
struct RenderPart {
    RenderState state;
    std::string settings, mark;  ///< as passed to write_state
};

/// Reads a part of a render, which one of several runs (option --share) has written to a file. If
/// `facts_only` is true, only the image size, the exposure and the number of halves (independent sets of
/// samples) are read. Returns nothing if the file is not such a part. Throws Error(invalid_input) if the part
/// is damaged.
[[nodiscard]] std::optional<RenderPart> read_render_part(const std::filesystem::path& path,
                                                         bool facts_only = false);

/// Reads an unfinished render from a file that write_state has written. The image size and the number of
/// halves (1 or 2 independent sets of samples) of `state` must already be set. Throws Error(invalid_input) if
/// the file is damaged, has other `settings` or is not from write_state.
void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state);

}  // namespace postlens
