// An OpenEXR file, flat or deep, of another program. All sizes are checked before memory is allocated.
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

/// What a part of an OpenEXR file is used for: the picture (`picture`), or one pass that the user gave in a
/// separate file (depth, ids or motion vectors).
enum class PartUse { picture, depth, ids, vectors };

/// Description of one part of the file, from its header.
struct ForeignPart {
    PartUse use = PartUse::picture;
    std::string name, view;          ///< empty if the part has none
    std::vector<std::string> views;  ///< `multiView`, main view first; empty if there is none
    Window data, display;            ///< inclusive corners; both hold at least one pixel
    bool deep = false, tiled = false;
    std::vector<std::string> channels;  ///< in file order, which is sorted

    [[nodiscard]] int width() const { return data.x_max - data.x_min + 1; }
    [[nodiscard]] int height() const { return data.y_max - data.y_min + 1; }
    [[nodiscard]] bool has(const std::string& channel) const;
};

enum class ChannelKind { half, float32, whole };

/// ForeignFile returns all values of a file as floats. A value of an integer channel is returned as the float
/// `bits`, which has the same bits as the integer. This function interprets these bits as an unsigned
/// integer, and converts its value to a float.
[[nodiscard]] inline float number_of_bits(float bits) {
    return static_cast<float>(std::bit_cast<std::uint32_t>(bits));
}

/// Subsampling steps of a channel. It has values only where x and y are multiples of the steps.
struct ChannelSampling {
    int x = 1, y = 1;
    friend bool operator==(const ChannelSampling&, const ChannelSampling&) = default;
};

/// A band of rows of a deep part.
struct DeepRows {
    int y_begin = 0, y_end = 0;            ///< file coordinates
    std::span<const std::uint32_t> count;  ///< samples of each pixel, row by row
    /// values[c] contains channel c: the samples of the first pixel, then those of the next pixel, and so on.
    /// An integer is stored as a float with the same bits.
    std::vector<std::span<const float>> values;
};

/// An OpenEXR file of another program, together with separate files for its passes (such as depth or ids).
/// Limits: a window (rectangle of pixels) may be up to 65536 px wide and high, and contain up to 2^29 px. A
/// chunk may have up to 256 MB.
///
/// Throws Error(invalid_input), with the name of the file, if the file is damaged, exceeds a limit, or claims
/// more data than its size allows. Throws Error(out_of_memory) if the memory does not suffice.
class ForeignFile {
  public:
    explicit ForeignFile(const std::filesystem::path& path);
    ~ForeignFile();
    ForeignFile(const ForeignFile&) = delete;
    ForeignFile& operator=(const ForeignFile&) = delete;
    ForeignFile(ForeignFile&&) noexcept;
    ForeignFile& operator=(ForeignFile&&) = delete;

    /// Adds a separate file, `path`, which contains the pass `use` of this image, such as depth or object
    /// ids. Throws Error(invalid_input) if the display window of the separate file has another size than that
    /// of the image.
    void attach(const std::filesystem::path& path, PartUse use);

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Returns the name of the file that contains the part.
    [[nodiscard]] const std::string& name_of(std::size_t part) const;
    [[nodiscard]] std::span<const ForeignPart> parts() const { return parts_; }
    /// Returns the names of all stereo views. Those that the attribute `multiView` lists come first.
    [[nodiscard]] std::span<const std::string> views() const { return views_; }
    /// Returns true if a separate file was attached for this pass.
    [[nodiscard]] bool has_own_file(PartUse use) const;

    /// The following functions return an attribute of a part of the file. Empty if the part has no attribute
    /// of this name and type.
    [[nodiscard]] std::optional<double> number(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::array<double, 2>> pair(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<Matrix44> matrix(std::size_t part, const char* name) const;
    [[nodiscard]] std::optional<std::string> text(std::size_t part, const char* name) const;
    /// Returns the names and values of all string attributes whose names begin with `prefix`.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> texts(std::size_t part,
                                                                         std::string_view prefix) const;

    /// Reads a flat image from top to bottom. Calls take(y, values) for each row, where values[c] points to
    /// the values of channel c. Integers are passed as floats with the same bits.
    void read_flat(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(int y, std::span<const float* const> values)>& take) const;
    /// Reads a deep image from top to bottom, and passes it to `take` in bands of rows.
    void read_deep(std::size_t part, std::span<const std::string> channels,
                   const std::function<void(const DeepRows&)>& take) const;
    /// Returns the type of a channel's values, or `half` if the part has no channel of that name.
    [[nodiscard]] ChannelKind kind(std::size_t part, const std::string& channel) const;
    [[nodiscard]] ChannelSampling sampling(std::size_t part, const std::string& channel) const;
    /// Returns the weights of red, green and blue in the luminance, computed from the file's chromaticities
    /// (Rec.709 if none are stored).
    [[nodiscard]] std::array<double, 3> luminance_weights(std::size_t part) const;
    /// Reads a subsampled channel of a flat image. Returns one value per pixel of the data window, row by
    /// row, interpolated bilinearly.
    [[nodiscard]] std::vector<float> read_sampled(std::size_t part, const std::string& channel) const;
    /// True if the file's lossy compression may change the bits of 32-bit floats, so that equal object ids
    /// become different.
    [[nodiscard]] bool loses_bits(std::size_t part) const;

  private:
    struct Impl;
    void open(const std::filesystem::path& path, PartUse use);

    std::string name_;
    std::vector<ForeignPart> parts_;
    std::vector<std::string> views_;
    std::unique_ptr<Impl> impl_;
};

/// A list of channels to read, without duplicates. A channel's number is its index in the list.
class ChannelList {
  public:
    /// Adds a channel name to the list unless it is already there. Returns its index, or nothing if the name
    /// is empty.
    std::optional<std::size_t> add(const std::string& name);
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  private:
    std::vector<std::string> names_;
};

/// Returns true if the file begins with the magic number of OpenEXR.
[[nodiscard]] bool is_openexr(const std::filesystem::path& path);

}  // namespace postlens
