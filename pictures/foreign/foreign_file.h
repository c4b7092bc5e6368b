// An OpenEXR file of another program, flat or deep. All sizes are checked before memory is allocated.
#pragma once

#include <array>
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

/// Use of a part. Parts of a separate file are used only for the pass of that file.
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

/// Subsampling of a channel: it has values where x and y are multiples of these numbers.
struct ChannelSampling {
    int x = 1, y = 1;
    friend bool operator==(const ChannelSampling&, const ChannelSampling&) = default;
};

/// A band of rows of a deep part.
struct DeepRows {
    int y_begin = 0, y_end = 0;            ///< file coordinates
    std::span<const std::uint32_t> count;  ///< samples of each pixel, row by row
    /// Values of each channel, pixel by pixel, sample by sample; their number is the sum of the counts.
    /// Integers are stored as their bits.
    std::vector<std::span<const float>> values;
};

/// An OpenEXR file and its separate files of passes. Throws Error(invalid_input), one line that names the
/// file, if the file is not a complete OpenEXR file: windows beyond 65536 px per edge or 2^29 px, chunks
/// beyond 256 MB, sizes that the file cannot hold, damaged data. Throws Error(out_of_memory) before memory is
/// allocated.
class ForeignFile {
  public:
    explicit ForeignFile(const std::filesystem::path& path);
    ~ForeignFile();
    ForeignFile(const ForeignFile&) = delete;
    ForeignFile& operator=(const ForeignFile&) = delete;
    ForeignFile(ForeignFile&&) noexcept;
    ForeignFile& operator=(ForeignFile&&) = delete;

    /// Adds the parts of another file, with a display window of the same size, for one pass. Throws the
    /// errors of the constructor, and Error(invalid_input) if the sizes differ.
    void attach(const std::filesystem::path& path, PartUse use);

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Name of the file that contains the part.
    [[nodiscard]] const std::string& name_of(std::size_t part) const;
    [[nodiscard]] std::span<const ForeignPart> parts() const { return parts_; }
    /// Views that parts name, each once; those of `multiView` first.
    [[nodiscard]] std::span<const std::string> views() const { return views_; }
    /// Whether a file was attached for a pass.
    [[nodiscard]] bool has_own_file(PartUse use) const;

    /// Attributes of a part; empty if there is none of that name and type.
    [[nodiscard]] std::optional<double> number(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::array<double, 2>> pair(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<Matrix44> matrix(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::string> text(std::size_t part, const char* name) const;
    /// Names and values of all string attributes whose names begin with `prefix`.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> texts(std::size_t part,
                                                                         std::string_view prefix) const;

    /// Reads a flat part from top to bottom, in bands of rows. `take(y, values)` receives one row, channel by
    /// channel, each of the part's width. Integers are passed as the bits of floats.
    void read_flat(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(int y, std::span<const float* const> values)>& take) const;
    /// Reads a deep part from top to bottom; `take` receives a band of rows.
    void read_deep(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(const DeepRows&)>& take) const;
    /// Type of a channel's values; `half` if there is no channel of that name.
    [[nodiscard]] ChannelKind kind(std::size_t part, const std::string& channel) const;
    [[nodiscard]] ChannelSampling sampling(std::size_t part, const std::string& channel) const;
    /// Weights of red, green and blue in the luminance of the part, from its chromaticities, or of Rec.709 if
    /// it has none.
    [[nodiscard]] std::array<double, 3> luminance_weights(std::size_t part) const;
    /// Reads a subsampled channel of a flat part: one value per pixel of the data window, row by row,
    /// interpolated bilinearly; constant beyond the last value.
    [[nodiscard]] std::vector<float> read_sampled(std::size_t part, const std::string& channel) const;
    /// True if the part's compression may turn equal 32-bit floats into different ones.
    [[nodiscard]] bool loses_bits(std::size_t part) const;

  private:
    struct Impl;
    void open(const std::filesystem::path& path, PartUse use);

    std::string name_;
    std::vector<ForeignPart> parts_;
    std::vector<std::string> views_;
    std::unique_ptr<Impl> impl_;
};

/// Names of channels to be read, each once. A channel's number is its index among the values read.
class ChannelList {
  public:
    /// Adds a channel, unless it is in the list, and returns its number; empty for an empty name.
    std::optional<std::size_t> add(const std::string& name);
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  private:
    std::vector<std::string> names_;
};

/// True if the file begins with the magic number of OpenEXR.
[[nodiscard]] bool is_openexr(const std::filesystem::path& path);

}  // namespace postlens
