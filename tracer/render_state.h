// The state of an unfinished render from which it can be resumed, and its file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "records/image.h"

namespace postlens {

/// Sums of radiance, with exposure, per pixel (3 doubles each, row-major), and their numbers of samples, for
/// one or two halves.
struct RenderState {
    int width = 0, height = 0, halves = 1;
    double exposure_stops = 0;  ///< of the sums
    std::array<std::vector<double>, 2> sums;
    std::array<std::vector<std::uint32_t>, 2> samples;  ///< per pixel

    RenderState() = default;
    RenderState(int w, int h, int count, double stops = 0);
    [[nodiscard]] static std::uint64_t bytes(int width, int height, int halves);
    /// The mean over all samples so far. Pixels without samples are black.
    [[nodiscard]] Image picture() const;
    [[nodiscard]] Image half(int which) const;
};

/// Writes an OpenEXR file: R, G, B hold the radiance so far, and further channels hold the exact bits of all
/// sums and counts. `settings` identifies the render. Throws Error(cannot_write).
void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings);

/// Fills `state`, whose size and halves are set, from a file of the same settings. Throws
/// Error(invalid_input) if the file was not written by write_state, is damaged or has other settings.
void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state);

}  // namespace postlens
