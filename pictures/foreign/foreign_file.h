// An OpenEXR file that another program wrote, flat or deep. All sizes are checked before memory is allocated.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pictures/exr/exr_input.h"

namespace postlens {

/// What a part is used for. Parts of a separate file are used only for the pass of that file.
enum class PartUse { picture, depth, ids, vectors };

/// Description of one part of the file, from its header.
struct ForeignPart {
    PartUse use = PartUse::picture;
    std::string name, view;          ///< empty if the part has none
    std::vector<std::string> views;  ///< `multiView`, main view first; empty if the part has none
    Window data, display;            ///< inclusive corners; both hold at least one pixel
    bool deep = false, tiled = false;
    std::vector<std::string> channels;  ///< in file order, which is sorted

    [[nodiscard]] int width() const { return data.x_max - data.x_min + 1; }
    [[nodiscard]] int height() const { return data.y_max - data.y_min + 1; }
    [[nodiscard]] bool has(const std::string& channel) const;
};

enum class ChannelKind { half, float32, whole };

/// Returns, as a number, the integer whose bits ForeignFile has stored in a float (in channels of integers).
[[nodiscard]] inline float number_of_bits(float bits) {
    return static_cast<float>(std::bit_cast<std::uint32_t>(bits));
}

/// Subsampling of a channel. The channel has values where x and y are multiples of these numbers.
struct ChannelSampling {
    int x = 1, y = 1;
    friend bool operator==(const ChannelSampling&, const ChannelSampling&) = default;
};

/// A band of rows of a deep part.
struct DeepRows {
    int y_begin = 0, y_end = 0;            ///< file coordinates
    std::span<const std::uint32_t> count;  ///< samples of each pixel, row by row
    /// Values of each channel, pixel by pixel, and sample by sample within a pixel. The number of values is
    /// the sum of the counts. Integers are stored as their bits.
    std::vector<std::span<const float>> values;
};

/// An OpenEXR file, together with separate files for passes. Throws Error(invalid_input), one line that names
/// the file, unless the file is a complete OpenEXR file within these limits: windows of at most 65536 px per
/// edge and 2^29 px in total, chunks of at most 256 MB, and sizes that the file can contain. Throws
/// Error(out_of_memory) before memory is allocated.
class ForeignFile {
  public:
    explicit ForeignFile(const std::filesystem::path& path);
    ~ForeignFile();
    ForeignFile(const ForeignFile&) = delete;
    ForeignFile& operator=(const ForeignFile&) = delete;
    ForeignFile(ForeignFile&&) noexcept;
    ForeignFile& operator=(ForeignFile&&) = delete;

    /// Adds the parts of another file for one pass. Both files must have display windows of the same size;
    /// otherwise, throws Error(invalid_input). Also throws the errors of the constructor.
    void attach(const std::filesystem::path& path, PartUse use);

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Name of the file that contains the part.
    [[nodiscard]] const std::string& name_of(std::size_t part) const;
    [[nodiscard]] std::span<const ForeignPart> parts() const { return parts_; }
    /// Names of all views, each once. Those in `multiView` come first.
    [[nodiscard]] std::span<const std::string> views() const { return views_; }
    /// True if a separate file was attached for this pass.
    [[nodiscard]] bool has_own_file(PartUse use) const;

    /// Attribute of a part; empty if the part has no attribute of that name and type.
    [[nodiscard]] std::optional<double> number(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::array<double, 2>> pair(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<Matrix44> matrix(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::string> text(std::size_t part, const char* name) const;
    /// Names and values of all string attributes whose names begin with `prefix`.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> texts(std::size_t part,
                                                                         std::string_view prefix) const;

    /// Reads a flat part from top to bottom. `take(y, values)` receives one row at a time: per channel, as
    /// many values as the part is wide. Integers are passed as their bits in floats.
    void read_flat(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(int y, std::span<const float* const> values)>& take) const;
    /// Reads a deep part from top to bottom. `take` receives one band of rows at a time.
    void read_deep(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(const DeepRows&)>& take) const;
    /// Type of a channel's values; `half` if the part has no channel of that name.
    [[nodiscard]] ChannelKind kind(std::size_t part, const std::string& channel) const;
    [[nodiscard]] ChannelSampling sampling(std::size_t part, const std::string& channel) const;
    /// Weights of red, green and blue in the luminance of the part. They follow from the part's
    /// chromaticities or, if it has none, from those of Rec.709.
    [[nodiscard]] std::array<double, 3> luminance_weights(std::size_t part) const;
    /// Reads a subsampled channel of a flat part. Returns one value per pixel of the data window, row by row,
    /// interpolated bilinearly. Pixels beyond the last value repeat that value.
    [[nodiscard]] std::vector<float> read_sampled(std::size_t part, const std::string& channel) const;
    /// True if the part's lossy compression may change equal 32-bit floats to different ones.
    [[nodiscard]] bool loses_bits(std::size_t part) const;

  private:
    struct Impl;
    void open(const std::filesystem::path& path, PartUse use);

    std::string name_;
    std::vector<ForeignPart> parts_;
    std::vector<std::string> views_;
    std::unique_ptr<Impl> impl_;
};

/// List of the channels to read, each once. A channel's number is its index among the values that are read.
class ChannelList {
  public:
    /// Adds a channel, unless the list already has it. Returns the channel's number; empty for an empty name.
    std::optional<std::size_t> add(const std::string& name);
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  private:
    std::vector<std::string> names_;
};

/// True if the file begins with the magic number of OpenEXR.
[[nodiscard]] bool is_openexr(const std::filesystem::path& path);

}  // namespace postlens
