// Reads the Cryptomatte of a flat image (one sample per pixel), and determines from it which surfaces each
// pixel of the image shows.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/cryptomatte.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Reads a Cryptomatte, which states the fraction of each pixel that each surface covers. `take` and `finish`
/// throw Error(invalid_input) and Error(out_of_memory).
class MatteShares {
  public:
    /// Prepares to read the Cryptomatte `matte` (a set of object masks) from `file`. Its channels may be in
    /// other file parts than the colours of the image, which are in the part `onto`. Their values are placed
    /// on the pixel grid of `onto`.
    MatteShares(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte);

    /// Starts to read the Cryptomatte together with the colours. Returns the names of its channels in `part`,
    /// the file part with the colours. The caller passes the values of these channels to take(). Returns no
    /// names if the channels must be read separately.
    [[nodiscard]] std::vector<std::string> begin_beside(std::size_t part);
    /// Receives values of the channels that begin_beside() returned, for `count` adjacent pixels from the
    /// index `pixel`, and stores the ids and covered fractions that they contain. values[c] points to the
    /// values of channel c. Throws Error(out_of_memory).
    void take(std::size_t pixel, std::size_t count, std::span<const float* const> values,
              ForeignPicture& picture);
    /// Reads those channels of the Cryptomatte that the caller did not read together with the colours and
    /// pass to take(). Then gives each sample of `picture` the id of the object that covers most of the
    /// sample's pixel.
    void finish(ForeignPicture& picture);

  private:
    struct Entry {
        std::size_t pixel = 0;
        SurfaceShare share;
    };
    [[nodiscard]] std::vector<std::string> channels(std::size_t part) const;
    void add_entries(ForeignPicture& picture);

    const ForeignFile& file_;
    const ForeignPart& onto_;
    const Cryptomatte& matte_;
    std::vector<std::size_t> parts_;    ///< the parts that have ranks, in the order of the ranks
    std::optional<std::size_t> taken_;  ///< the part whose values are passed to `take`
    std::vector<Entry> entries_;        ///< of one row of pixels, or of all if several parts have ranks
};

}  // namespace postlens
