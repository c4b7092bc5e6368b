// Channels of other parts and files, laid onto the pixels of the part that has the colours.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "records/foreign_file.h"

namespace postlens {

/// Rows of a flat part as far as they lie in the data window of part `onto`, both counted from the corner of
/// their display windows: `take(pixel, count, from, values)`, of `count` pixels from number `pixel` of `onto`
/// on, whose values begin at `from` in each channel's row.
using TakeRow = std::function<void(std::size_t pixel, std::size_t count, std::size_t from,
                                   std::span<const float* const> values)>;
void each_row_onto(const ForeignFile& file, std::size_t part, std::span<const std::string> channels,
                   const ForeignPart& onto, const TakeRow& take);

/// One channel for each pixel of `onto`, row by row; `otherwise` where the part stores nothing. Throws
/// Error(out_of_memory).
[[nodiscard]] std::vector<float> plane_onto(const ForeignFile& file, std::size_t part,
                                            const std::string& channel, const ForeignPart& onto,
                                            float otherwise);

/// Channels of several parts, read row by row as if all of them were in one.
class JoinedChannels {
  public:
    /// `part`: whose data window is read.
    JoinedChannels(const ForeignFile& file, std::size_t part) : file_(file), part_(part) {}

    /// Number of its values below; absent for a channel without a name. `otherwise`: where another part
    /// stores nothing. `interpolated`: it may have fewer values than pixels (ForeignFile::read_sampled),
    /// which else are refused. A channel added twice has one number. What lies in another part is read here.
    std::optional<std::size_t> add(std::size_t part, const std::string& name, float otherwise,
                                   bool interpolated = false);
    [[nodiscard]] const std::string& name(std::size_t number) const { return channels_[number].name; }
    /// From the top down: `take(y, values)` gets a row, channel by channel.
    void read(const std::function<void(int y, std::span<const float* const> values)>& take) const;

  private:
    struct Channel {
        std::size_t part = 0;
        std::string name;
        std::vector<float> plane;  ///< empty: in the part that is read
        std::size_t row = 0;       ///< number in its rows
    };
    const ForeignFile& file_;
    std::size_t part_;
    std::vector<Channel> channels_;
    std::vector<std::string> own_;
};

}  // namespace postlens
