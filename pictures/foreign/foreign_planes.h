// Reads passes, such as depth, that are in another file part or another file than the colours. Shifts their
// values to the pixel grid of the part with the colours.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// Receives one row of pixels from each_row_onto(). That function reads channels of one file part and places
/// them on the pixel grid of another file part, `onto`.
/// - `pixel`: index of the row's first pixel in `onto`
/// - `count`: number of pixels
/// - `from`, `values`: values[c] is a whole row of channel c in the part that is read. This row may begin
///   outside `onto`, so the values of the pixels begin at values[c][from].
using TakeRow = std::function<void(std::size_t pixel, std::size_t count, std::size_t from,
                                   std::span<const float* const> values)>;
/// Reads channels of the flat file part `part`, and places them on the pixel grid of another file part,
/// `onto`. The upper left corner of the display window of `part` is placed on that of `onto`. Calls `take`
/// for each row of pixels that both parts store.
void each_row_onto(const ForeignFile& file, std::size_t part, std::span<const std::string> channels,
                   const ForeignPart& onto, const TakeRow& take);

/// Returns the values of a channel of the file part `part` on the pixel grid of another file part, `onto`:
/// one value for each pixel that `onto` stores, row by row. With `converts`, integers are converted to
/// floats. Throws Error(out_of_memory).
///
/// If `part` does not store a pixel, the pixel gets the value `otherwise` inside the display window of
/// `onto`. Outside this window, it gets the nearest value that `part` stores.
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
