// Reads passes of an image, such as depth, that are stored in another part of an OpenEXR file than the
// colours, or in another file. Places their values on the pixel grid of the part with the colours.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// Receives one row of pixels from each_row_onto(), which places channels on the pixel grid of the file part
/// `onto`.
/// - `pixel`: index of the row's first pixel in `onto`
/// - `count`: number of pixels
/// - `values`: values[c] is the row of channel c, as it is stored in the part that is read
/// - `from`: index, in values[c], of the value for the first pixel
using TakeRow = std::function<void(std::size_t pixel, std::size_t count, std::size_t from,
                                   std::span<const float* const> values)>;
/// Reads channels of the flat file part `part` and places them on the pixel grid of another part, `onto`, so
/// that the upper left corners of their display windows (visible rectangles) coincide. Calls `take` for each
/// row of pixels that both parts store.
void each_row_onto(const ForeignFile& file, std::size_t part, std::span<const std::string> channels,
                   const ForeignPart& onto, const TakeRow& take);

/// Returns a channel of the file part `part` for each pixel that another part, `onto`, stores, row by row.
/// With `converts`, integers are converted to floats. Throws Error(out_of_memory).
///
/// A pixel that `part` does not store gets the value `otherwise` inside the display window (visible
/// rectangle) of `onto`. Outside this window, it gets the value of the nearest pixel that `part` stores.
[[nodiscard]] std::vector<float> plane_onto(const ForeignFile& file, std::size_t part,
                                            const std::string& channel, const ForeignPart& onto,
                                            float otherwise, bool converts);

/// How the values of a channel are read:
/// - number: as floats; integers are converted
/// - interpolated: as `number`; the channel may be subsampled (ForeignFile::read_sampled)
/// - id: floats stay floats; integers are passed as their bits, because a float cannot represent every id
enum class ChannelUse { number, interpolated, id };

/// Reads channels of several parts row by row, as if they were in a single part.
class JoinedChannels {
  public:
    /// Reads the pixels in the data window of `part`.
    JoinedChannels(const ForeignFile& file, std::size_t part) : file_(file), part_(part) {}

    /// Adds a channel to be read. Returns its index in the rows' `values` (see `read`), or empty if `name` is
    /// empty. Pixels that the file does not store get the value `otherwise`.
    std::optional<std::size_t> add(std::size_t part, const std::string& name, float otherwise,
                                   ChannelUse use = ChannelUse::number);
    [[nodiscard]] const std::string& name(std::size_t number) const { return channels_[number].name; }
    /// Reads the image from top to bottom. Calls take(y, values) for each row, with one pointer per channel.
    void read(const std::function<void(int y, std::span<const float* const> values)>& take) const;

  private:
    struct Channel {
        std::size_t part = 0;
        std::string name;
        ChannelUse use = ChannelUse::number;
        std::vector<float> plane;  ///< empty for a channel of the part that is read row by row
        std::size_t row = 0;       ///< index of the channel within the rows of that part
        bool converted = false;    ///< whether these rows contain integers to convert to floats
    };
    const ForeignFile& file_;
    std::size_t part_;
    std::vector<Channel> channels_;
    ChannelList own_;
};

}  // namespace postlens
