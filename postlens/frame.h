/// @file
/// Sample files: what a file holds, its records, and the open file from which pictures are made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <postlens/job.h>
#include <string>
#include <vector>

namespace postlens::api {

/// What a file holds, as `postlens info` says. Members that only sample files have are 0 or empty for a
/// picture of another program.
struct FrameInfo {
    std::string kind = {};      ///< "samples": a sample file; "image": a picture of another program.
    int width = 0;              ///< Width of the pictures made from the file, px.
    int height = 0;             ///< Height of the pictures made from the file, px.
    std::uint64_t records = 0;  ///< Number of records of all instants.
    int layers = 0;       ///< Number of layers: 1 plus the hidden surfaces recorded behind visible ones.
    int overscan_px = 0;  ///< Pixels traced beyond each border of the picture, px.
    std::vector<double> instants_s =
        {};  ///< Recorded instants on the scene's clock, the frame's own first, s.
    std::map<std::uint32_t, std::string> ids = {};  ///< Name of each object by its id.
    std::optional<double> focal_length_mm = {};     ///< Focal length in the file, mm.
    std::optional<double> film_distance_mm = {};    ///< Distance from the pinhole to the film, mm.
    std::optional<double> f_number = {};            ///< F-number in the file.
    std::optional<double> focus_distance_m = {};    ///< Focus distance in the file, m.
    std::optional<double> exposure_stops = {};      ///< Exposure of the pictures, stops.
    Report report = {};                             ///< Of `postlens info`; its JSON says more.
};

/// The records of one instant: one value per record in each column, sorted by pixel, and within a pixel by
/// layer, y, x and path. docs/sample_file.md defines the quantities.
struct Records {
    int x_begin = 0;  ///< First traced column, px: minus the overscan.
    int y_begin = 0;  ///< First traced row, px: minus the overscan.
    int columns = 0;  ///< Number of traced columns, overscan included.
    int rows = 0;     ///< Number of traced rows, overscan included.
    /// The pixel in row i and column j of the traced raster has the records offsets[k] to offsets[k + 1] - 1,
    /// k = i * columns + j. There are rows * columns + 1 values.
    std::vector<std::uint32_t> offsets = {};
    std::vector<float> x = {};  ///< Raster position, px to the right; pixel i covers i to i + 1.
    std::vector<float> y = {};  ///< Raster position, px down.
    std::vector<float> z =
        {};  ///< z', length of the path along the optical axis, m; infinite where nothing was hit.
    /// Radiance times the throughput of the path: red, green and blue of each record, scene-linear. A point
    /// sample is the sum of its nodes.
    std::vector<float> rgb = {};
    std::vector<std::uint32_t> id = {};  ///< Object; 0: nothing was hit.
    /// Bounces from the eye to the node, two bits each from the lowest: 1 reflected, 2 transmitted. 0: the
    /// surface is seen directly.
    std::vector<std::uint32_t> path = {};
    std::vector<std::uint32_t> layer = {};  ///< 0: visible from the pinhole; n: the n-th surface behind it.
    /// W, 1/m: xx, xy, yx and yy of each record. The node's image moves on the raster by -W q for the lens
    /// point q. For a surface that is seen directly W = I / z' [Igehy 1999].
    std::vector<float> w = {};
    /// Second-order error of W, 1/m^2. Infinite: other lens points do not see the node by this path.
    std::vector<float> w_bend = {};
};

/// A sample file, or an OpenEXR picture of another program with depth, from which pictures are made. Of a
/// sample file the records stay in memory between pictures, about as large as the uncompressed file. A copy
/// refers to the same open file. One frame makes one picture at a time; further calls wait.
class Frame {
  public:
    /// Opens a file. Throws Error(invalid_input) if the file is missing, damaged or cannot be focused.
    /// @param path The sample file, or the picture of another program.
    /// @param salvage Reads the undamaged rows of a damaged sample file (`--salvage`).
    explicit Frame(std::filesystem::path path, bool salvage = false);

    /// @return The file.
    [[nodiscard]] const std::filesystem::path& path() const noexcept;
    /// @return What the file holds.
    [[nodiscard]] const FrameInfo& info() const noexcept;
    /// Reads the records of an instant. Throws Error(wrong_arguments) if there is no such instant or the file
    /// has no records.
    /// @param instant 0: the frame's own; n: the n-th key.
    /// @param job Threads, progress and cancellation; null: a thread per core.
    /// @return The records; colours are radiance, whatever the exposure.
    [[nodiscard]] Records records(std::size_t instant = 0, Job* job = nullptr) const;

  private:
    friend struct Internals;
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace postlens::api
