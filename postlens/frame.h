/// @file
/// Sample files: their properties, their records, and the open file from which pictures are made.
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

/// Properties of a file, as reported by `postlens info`. Members that only sample files have are 0 or empty
/// for a picture of another program.
struct FrameInfo {
    std::string kind = {};      ///< "samples": a sample file; "image": a picture of another program.
    int width = 0;              ///< Width of the pictures made from the file, px.
    int height = 0;             ///< Height of the pictures made from the file, px.
    std::uint64_t records = 0;  ///< Number of records of all instants.
    /// Number of layers: 1, plus the number of hidden surfaces recorded behind visible ones.
    int layers = 0;
    int overscan_px = 0;  ///< Pixels traced beyond each border of the picture, px.
    std::vector<double> instants_s =
        {};  ///< Recorded instants on the scene's clock, the frame's own first, s.
    std::map<std::uint32_t, std::string> ids = {};  ///< Name of each object by its id.
    std::optional<double> focal_length_mm = {};     ///< Focal length in the file, mm.
    std::optional<double> film_distance_mm = {};    ///< Distance from the pinhole to the film, mm.
    std::optional<double> f_number = {};            ///< F-number in the file.
    std::optional<double> focus_distance_m = {};    ///< Focus distance in the file, m.
    std::optional<double> exposure_stops = {};      ///< Exposure of the pictures, stops.
    Report report = {};  ///< Report of `postlens info`; its JSON has further properties.
};

/// The records of one instant. Each column has one value per record. Records are sorted by pixel, and within
/// a pixel by layer, y, x and path. docs/sample_file.md defines the quantities.
struct Records {
    int x_begin = 0;  ///< First traced column, px: minus the overscan.
    int y_begin = 0;  ///< First traced row, px: minus the overscan.
    int columns = 0;  ///< Number of traced columns, overscan included.
    int rows = 0;     ///< Number of traced rows, overscan included.
    /// The pixel in row i and column j of the traced raster has the index k = i * columns + j. Its records
    /// are offsets[k] to offsets[k + 1] - 1. There are rows * columns + 1 offsets.
    std::vector<std::uint32_t> offsets = {};
    std::vector<float> x = {};  ///< Raster position, px to the right; pixel i covers i to i + 1.
    std::vector<float> y = {};  ///< Raster position, px down.
    std::vector<float> z =
        {};  ///< z', the path length along the optical axis, m; infinite if nothing was hit.
    /// Radiance times the throughput of the path: red, green and blue of each record, scene-linear. The
    /// radiance of a point sample is the sum over its nodes.
    std::vector<float> rgb = {};
    std::vector<std::uint32_t> id = {};  ///< Object; 0: nothing was hit.
    /// Bounces from the eye to the node, two bits each, starting with the lowest bits: 1 reflected, 2
    /// transmitted. 0 if the surface is seen directly.
    std::vector<std::uint32_t> path = {};
    std::vector<std::uint32_t> layer = {};  ///< 0: visible from the pinhole; n: the n-th surface behind it.
    /// The matrix W, 1/m: elements xx, xy, yx and yy of each record. Seen from the lens point q, in m from
    /// the lens's centre, the tangent of the direction to the node is less by W q than seen from the centre.
    /// This difference times film distance / pixel pitch is the shift of the node's image, px. For a surface
    /// that is seen directly, W = I / z' [Igehy 1999].
    std::vector<float> w = {};
    /// Second-order error of W over the lens, 1/m^2. Infinite if other lens points do not see the node by
    /// this path.
    std::vector<float> w_bend = {};
};

/// A sample file, or an OpenEXR picture of another program with depth, from which pictures are made. The
/// records of a sample file stay in memory between pictures; they are about as large as the uncompressed
/// file. Copies of a frame share the open file. A frame makes one picture at a time; further calls wait.
class Frame {
  public:
    /// Opens a file. Throws Error(invalid_input) if the file is missing or damaged, or cannot be focused.
    /// @param path The sample file, or the picture of another program.
    /// @param salvage Reads the undamaged rows of a damaged sample file (`--salvage`).
    explicit Frame(std::filesystem::path path, bool salvage = false);

    /// @return The file.
    [[nodiscard]] const std::filesystem::path& path() const noexcept;
    /// @return What the file holds.
    [[nodiscard]] const FrameInfo& info() const noexcept;
    /// Reads the records of an instant. Throws Error(wrong_arguments) if the file has no records, or none for
    /// this instant.
    /// @param instant 0: the frame's own instant; n: the n-th further recorded instant.
    /// @param job Threads, progress and cancellation; null: a thread per core.
    /// @return The records. Colours are radiance; the exposure does not change them.
    [[nodiscard]] Records records(std::size_t instant = 0, Job* job = nullptr) const;

  private:
    friend struct Internals;
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace postlens::api
