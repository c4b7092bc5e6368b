// Determines, from its Cryptomatte, which surfaces each pixel of a flat image shows.
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
    /// several file parts. Their values are read at the pixels of `onto`, the part that contains the colours.
    MatteShares(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte);

    /// Returns the Cryptomatte channels that are stored in `part`, the file part with the colours. The caller
    /// reads them together with the colours, so that the part is read only once, and passes their values to
    /// take(). Returns none if the first Cryptomatte channels are in another part, because finish() then
    /// reads all of them.
    [[nodiscard]] std::vector<std::string> begin_beside(std::size_t part);
    /// Receives values of the Cryptomatte channels that begin_beside() returned, and stores the ids and
    /// covered fractions that they contain. The values are those of `count` adjacent pixels, of which the
    /// first has the index `pixel`. values[c] points to the values of channel c. Throws Error(out_of_memory).
    void take(std::size_t pixel, std::size_t count, std::span<const float* const> values,
              ForeignPicture& picture);
    /// Reads the Cryptomatte channels that take() has not received. Then gives each sample the id of the
    /// object that covers most of its pixel.
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
