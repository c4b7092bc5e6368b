// Determines which surfaces each pixel of a flat image shows, using the Cryptomatte of the image.
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

/// Reads a Cryptomatte, which states what fraction of each pixel each surface covers. `take` and `finish`
/// throw Error(invalid_input) and Error(out_of_memory).
class MatteShares {
  public:
    /// `onto` is the part of the file with the colours. The fractions are determined for its pixels.
    MatteShares(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte);

    /// Returns the channels of the Cryptomatte that are in `part`, the part with the colours. The caller must
    /// read these channels together with the colours and pass them to `take`, row by row from top to bottom.
    /// The part is then decompressed only once. Returns an empty list if the first rank is in another part,
    /// because ranks must be read in order.
    [[nodiscard]] std::vector<std::string> begin_beside(std::size_t part);
    /// Receives the values of `count` adjacent pixels, whose samples must be in `picture`. `pixel` is the
    /// index of the first one. `values` has one pointer per channel, which points to the value of the first
    /// pixel.
    void take(std::size_t pixel, std::size_t count, std::span<const float* const> values,
              ForeignPicture& picture);
    /// Reads the parts that were not passed to `take`. Gives each sample of `picture` the id of the surface
    /// that covers most of its pixel. Adds pixels that show several surfaces to ForeignPicture::mixed.
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
