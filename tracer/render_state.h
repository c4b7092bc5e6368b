// What of a render in progress must be kept to go on with it, and its file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "records/image.h"

namespace postlens {

/// Sums of exposed radiance by pixel (3 doubles each, row-major), of one or two halves, and how many samples
/// are in them.
struct RenderState {
    int width = 0, height = 0, halves = 1;
    double exposure_stops = 0;  ///< of the sums
    std::array<std::vector<double>, 2> sums;
    std::array<std::vector<std::uint32_t>, 2> samples;  ///< per pixel

    RenderState() = default;
    RenderState(int w, int h, int count, double stops = 0);
    [[nodiscard]] static std::uint64_t bytes(int width, int height, int halves);
    /// The mean over all samples so far; black where there are none.
    [[nodiscard]] Image picture() const;
    [[nodiscard]] Image half(int which) const;
};

/// Writes an OpenEXR file: R, G, B of the radiance as far as they are, and every sum and count bit by bit in
/// further channels. `settings` identifies what is rendered. Throws Error(cannot_write).
void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings);

/// Fills `state`, whose size and halves are set, from a file of the same settings. Throws
/// Error(invalid_input) where the file is not one of ours, damaged, or of other settings.
void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state);

}  // namespace postlens
