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

/// Properties of a file, as reported by `postlens info`. Members that do not apply to a picture of another
/// program are 0 or empty.
struct FrameInfo {
    std::string kind = {};      ///< "samples" for a sample file, "image" for another program's picture.
    int width = 0;              ///< Width of the pictures made from the file, px.
    int height = 0;             ///< Height of the pictures made from the file, px.
    std::uint64_t records = 0;  ///< Number of records at all instants.
    /// Number of layers: one for the visible surfaces, plus one for each layer of hidden surfaces behind
    /// them.
    int layers = 0;
    int overscan_px = 0;  ///< Pixels traced beyond each border of the picture, px.
    std::vector<double> instants_s =
        {};  ///< Recorded instants on the scene's clock, s. The first is the instant of the frame.
    std::map<std::uint32_t, std::string> ids = {};  ///< Name of each object by its id.
    std::optional<double> focal_length_mm = {};     ///< Focal length in the file, mm.
    std::optional<double> film_distance_mm = {};    ///< Distance from the pinhole to the film, mm.
    std::optional<double> f_number = {};            ///< F-number in the file.
    std::optional<double> focus_distance_m = {};    ///< Focus distance in the file, m.
    std::optional<double> exposure_stops = {};      ///< Exposure of the pictures, stops.
    Report report = {};  ///< Report of `postlens info`. Its JSON has further properties.
};

/// The records of one instant: surfaces that eye rays hit. Each property of the records is an array, with one
/// value (or a fixed number of values) per record. Records are sorted by pixel, and within a pixel by layer,
/// then by the position y and x of the eye ray, then by path. docs/sample_file.md defines these quantities.
struct Records {
    int x_begin = 0;  ///< First traced column, px. It is -overscan_px.
    int y_begin = 0;  ///< First traced row, px. It is -overscan_px.
    int columns = 0;  ///< Number of traced columns, overscan included.
    int rows = 0;     ///< Number of traced rows, overscan included.
    /// The traced pixel in row i and column j has the index k = i * columns + j. Its records are those from
    /// offsets[k] to offsets[k + 1] - 1. There are rows * columns + 1 offsets.
    std::vector<std::uint32_t> offsets = {};
    std::vector<float> x = {};  ///< Raster position, px to the right; pixel i covers i to i + 1.
    std::vector<float> y = {};  ///< Raster position, px down.
    std::vector<float> z =
        {};  ///< z', the path length along the optical axis, m; infinite if nothing was hit.
    /// Red, green and blue of each record. They are the scene-linear radiance of the surface times the
    /// throughput of the path from the eye to it, i.e. what the surface adds to the eye ray. Therefore, the
    /// radiance of an eye ray is the sum over its records.
    std::vector<float> rgb = {};
    std::vector<std::uint32_t> id = {};  ///< Number of the object, or 0 if nothing was hit.
    /// The reflections and transmissions from the eye to the recorded surface. Each takes two bits: 1 is a
    /// reflection, and 2 a transmission. The lowest two bits are for the one nearest to the eye. The value is
    /// 0 if the surface is seen directly.
    std::vector<std::uint32_t> path = {};
    std::vector<std::uint32_t> layer = {};  ///< 0 for a visible surface; n for the n-th surface behind it.
    /// The 2x2 matrix W of each record, in 1/m, as xx, xy, yx, yy. W describes how the image of the record's
    /// surface moves when the lens point moves. If the lens point moves by the vector q, in m, the image
    /// moves by -W q times film distance / pixel pitch, in px. For a surface seen directly, W is the unit
    /// matrix divided by the depth [Igehy 1999].
    std::vector<float> w = {};
    /// Error of the matrix W (`w`) of each record, in 1/m^2. When the lens point moves, the image of the
    /// surface moves too. W describes this motion as a linear function, but in curved mirrors and through
    /// glass it is nonlinear. For a lens point R metres from the lens centre, W gives a position that is
    /// wrong by `w_bend` * R^2 * film distance / pixel pitch, in px. The error is 0 if it was not measured.
    /// It is infinite if other lens points see the surface by other reflections or refractions.
    std::vector<float> w_bend = {};
};

/// An open file from which pictures are made: a sample file, or an OpenEXR picture of another program with
/// depth. The records of a sample file stay in memory between pictures, and need about as much space as the
/// uncompressed file. Copies of a frame share the open file. A frame makes only one picture at a time, and
/// further calls wait.
class Frame {
  public:
    /// Opens a file. Throws Error(invalid_input) if the file is missing or damaged, or if no picture can be
    /// made from it.
    /// @param path The sample file, or the picture of another program.
    /// @param salvage Whether to read the undamaged rows of a damaged sample file (`--salvage`).
    explicit Frame(std::filesystem::path path, bool salvage = false);

    /// @return The file.
    [[nodiscard]] const std::filesystem::path& path() const noexcept;
    /// @return What the file holds.
    [[nodiscard]] const FrameInfo& info() const noexcept;
    /// Reads the records of one recorded instant, i.e. the surfaces that the eye rays hit. A moving scene may
    /// be recorded at several instants (FrameInfo::instants_s). Throws Error(wrong_arguments) if the file has
    /// no records of this instant, or none at all.
    /// @param instant Index in FrameInfo::instants_s: 0 for the instant of the frame, n for the n-th further
    /// one.
    /// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
    /// @return The records. Their colours are radiance, whatever the exposure of the file.
    [[nodiscard]] Records records(std::size_t instant = 0, Job* job = nullptr) const;

  private:
    friend struct Internals;
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace postlens::api
