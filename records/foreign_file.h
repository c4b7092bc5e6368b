// An OpenEXR file of another program, flat or deep, opened with every size checked before memory is taken.
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

#include "records/exr_input.h"

namespace postlens {

/// What the parts of a file are there for: those of passes' own files for that pass alone.
enum class PartUse { picture, depth, ids, vectors };

/// What one part of the file says of itself.
struct ForeignPart {
    PartUse use = PartUse::picture;
    std::string name, view;          ///< empty where the part has none
    std::vector<std::string> views;  ///< `multiView`, the hero first; empty where the part has none
    Window data, display;            ///< inclusive corners; both hold at least one pixel
    bool deep = false, tiled = false;
    std::vector<std::string> channels;  ///< in file order, which is sorted

    [[nodiscard]] int width() const { return data.x_max - data.x_min + 1; }
    [[nodiscard]] int height() const { return data.y_max - data.y_min + 1; }
    [[nodiscard]] bool has(const std::string& channel) const;
};

enum class ChannelKind { half, float32, whole };

/// Every how many columns and rows a channel has a value; the first at multiples of these numbers.
struct ChannelSampling {
    int x = 1, y = 1;
    friend bool operator==(const ChannelSampling&, const ChannelSampling&) = default;
};

/// A band of rows of a deep part.
struct DeepRows {
    int y_begin = 0, y_end = 0;            ///< file coordinates
    std::span<const std::uint32_t> count;  ///< samples of each pixel, row by row
    /// By channel, pixel by pixel, sample by sample: as many numbers as the counts add up to. Of channels of
    /// whole numbers, their bits.
    std::vector<std::span<const float>> values;
};

/// Throws Error(invalid_input), one line that names the file, for whatever is no whole OpenEXR file: windows
/// beyond 65536 px an edge or 2^29 px, chunks beyond 256 MB, sizes that the file cannot hold, damaged data;
/// Error(out_of_memory) before memory is taken.
class ForeignFile {
  public:
    explicit ForeignFile(const std::filesystem::path& path);
    ~ForeignFile();
    ForeignFile(const ForeignFile&) = delete;
    ForeignFile& operator=(const ForeignFile&) = delete;
    ForeignFile(ForeignFile&&) noexcept;
    ForeignFile& operator=(ForeignFile&&) = delete;

    /// Adds the parts of another file, of the same display window's size, for one pass. Throws as the
    /// constructor does, and Error(invalid_input) where the sizes differ.
    void attach(const std::filesystem::path& path, PartUse use);

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Of the file that the part is in.
    [[nodiscard]] const std::string& name_of(std::size_t part) const;
    [[nodiscard]] std::span<const ForeignPart> parts() const { return parts_; }
    /// The views that parts name, `multiView`'s first; each once.
    [[nodiscard]] std::span<const std::string> views() const { return views_; }
    /// Whether a file was attached for a pass.
    [[nodiscard]] bool has_own_file(PartUse use) const;

    /// Attributes of a part; absent where it has none of that name and type.
    [[nodiscard]] std::optional<double> number(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::array<double, 2>> pair(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<Matrix44> matrix(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::string> text(std::size_t part, const char* name) const;
    /// All texts whose names begin with `prefix`: names and values.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> texts(std::size_t part,
                                                                         std::string_view prefix) const;

    /// The rows of a flat part from the top down, a band at a time: `take(y, values)` gets one row, channel
    /// by channel, each of the part's width. Channels of whole numbers come as the bits of floats.
    void read_flat(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(int y, std::span<const float* const> values)>& take) const;
    /// The same of a deep part.
    void read_deep(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(const DeepRows&)>& take) const;
    /// What a channel holds; `half` where there is none of that name.
    [[nodiscard]] ChannelKind kind(std::size_t part, const std::string& channel) const;
    [[nodiscard]] ChannelSampling sampling(std::size_t part, const std::string& channel) const;
    /// What red, green and blue have of the part's luminance, by its chromaticities, else by those of Rec.
    /// 709.
    [[nodiscard]] std::array<double, 3> luminance_weights(std::size_t part) const;
    /// A channel of a flat part that has fewer values than pixels: a value for each pixel of the data window,
    /// row by row, interpolated linearly along rows and columns; beyond the last value it stays.
    [[nodiscard]] std::vector<float> read_sampled(std::size_t part, const std::string& channel) const;
    /// Whether the part's compression may make different 32-bit floats of equal ones.
    [[nodiscard]] bool loses_bits(std::size_t part) const;

  private:
    struct Impl;
    void open(const std::filesystem::path& path, PartUse use);

    std::string name_;
    std::vector<ForeignPart> parts_;
    std::vector<std::string> views_;
    std::unique_ptr<Impl> impl_;
};

/// Names of channels to be read, each once: numbers are those of the values read.
class ChannelList {
  public:
    /// Absent for a channel without a name.
    std::optional<std::size_t> add(const std::string& name);
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  private:
    std::vector<std::string> names_;
};

/// An OpenEXR file, whatever is in it.
[[nodiscard]] bool is_openexr(const std::filesystem::path& path);

}  // namespace postlens
