// Blur kernels (impulse responses on the pixel grid), in a form that is fast to add to an image, and a table
// of them.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <tbb/concurrent_unordered_map.h>
#include <utility>
#include <vector>

#include "lens/ellipse_coverage.h"
#include "lens/outline_rows.h"
#include "lens/response_grid.h"

namespace postlens {

/// One row of a blur kernel. It covers the columns [x_begin, x_end), relative to the pixel at which the
/// kernel is added to the image. The columns [inner_begin, inner_end) share the value Kernel::inner. Each
/// other column has its own value, called a tap.
struct KernelRow {
    std::int32_t x_begin = 0, inner_begin = 0, inner_end = 0, x_end = 0;
    std::uint32_t tap = 0;  ///< index of the row's first tap
    float sum = 0;          ///< sum of the row's values
};

/// Limits of a blur kernel: it is clipped to the columns [-x, x) and rows [-y, y) around a sample. x and y
/// are so large that the clipped part would lie outside the image for every sample.
struct KernelReach {
    int x = 0, y = 0;
};

/// A blur kernel: the impulse response of the lens on the pixel grid, that is, how the light of one point is
/// distributed over pixels. It is added to the image at a whole pixel, the anchor. Its values add up to 1,
/// unless `KernelReach` clips it.
struct Kernel {
    int y_begin = 0;  ///< row of rows.front(), relative to the anchor
    float inner = 0;
    std::vector<KernelRow> rows;
    std::vector<float> taps;
    int x_begin = 0, x_end = 0;  ///< columns over all rows

    [[nodiscard]] int y_end() const { return y_begin + static_cast<int>(rows.size()); }
    /// Returns the value of the kernel in one pixel: in the row `row` of this kernel, and in a column from
    /// row.x_begin to row.x_end (exclusive). Most pixels inside the kernel have the same value, `inner`. Only
    /// the others are stored in `taps`.
    [[nodiscard]] double at(const KernelRow& row, int column) const {
        if (column >= row.inner_begin && column < row.inner_end) return static_cast<double>(inner);
        const int tap = column < row.inner_begin ? column - row.x_begin
                                                 : column - row.x_begin - (row.inner_end - row.inner_begin);
        return static_cast<double>(taps[row.tap + static_cast<std::uint32_t>(tap)]);
    }
};

/// Builds the blur kernel of a uniform ellipse. A kernel is added to the image at a whole pixel. The
/// ellipse's centre lies (phase_x, phase_y) px from there. The kernel is clipped to the rows and columns
/// `reach` around this pixel, because farther values would lie outside the image.
[[nodiscard]] Kernel make_kernel(const Ellipse& ellipse, double phase_x, double phase_y, KernelReach reach);
/// Builds the blur kernel of a uniform shape (`outline`) or of a grid of values (`grid`). Their coordinates,
/// in px, are relative to the pixel at which the kernel is added to the image. The kernel is clipped to the
/// rows and columns `reach` around this pixel.
[[nodiscard]] Kernel make_kernel(const OutlineRows& outline, KernelReach reach);
[[nodiscard]] Kernel make_kernel(const ResponseGrid& grid, KernelReach reach);

class ResponseModel;
struct ResponseRequest;

/// Identifies a blur kernel in the table of kernels: its shape, and the subpixel position of its centre.
struct KernelKey {
    /// The centres of blur kernels are rounded to 1/16 px.
    static constexpr int phase_steps = 16;
    /// Sizes of blur ellipses are rounded to multiples of this, in px, so that samples share kernels.
    static constexpr double ellipse_step_px = 0.25;
    /// Limits of the blur radius, in px, below which the size of a highlight's blur ellipse is rounded more
    /// finely. The size is rounded to a multiple of ellipse_step_px / 4^k, where k is the index of the
    /// smallest limit above the radius. For other surfaces, k is 0.
    static constexpr std::array<double, 3> fineness_below_px = {HUGE_VAL, 4000, 8};
    /// Largest size of a blur ellipse, in px. Larger ones are scaled down.
    static constexpr double largest_ellipse_px = 16000;

    bool is_disc = true;
    std::int32_t fineness = 0;
    std::uint32_t level = 0;                                             ///< depth level of a disc
    std::int32_t half_height = 0, half_chord = 0, top_displacement = 0;  ///< of an ellipse, in steps
    std::int32_t phase_x = 0, phase_y = 0;  ///< subpixel position, -16 to 16, in units of 1/phase_steps px

    /// True if the aperture is not round. The blur is then not an ellipse, but described by a 2x2 matrix that
    /// converts lens points to px. Its four entries are stored, column by column, in half_height, half_chord,
    /// top_displacement and map_yy.
    bool is_map = false;
    std::int32_t map_yy = 0;
    bool upside_down = false;             ///< a disc in front of the focus
    std::int32_t cell_x = 0, cell_y = 0;  ///< cell of the image, counted from its centre
    std::int32_t cell_log2 = 0;  ///< the cell is 2^cell_log2 px wide; if 0, one cell is the whole image

    [[nodiscard]] static KernelKey disc(std::uint32_t level) { return {.level = level}; }
    /// Returns the key that identifies the blur kernel of an ellipse. The size of the ellipse is rounded to
    /// multiples of ellipse_step_px, so that similar ellipses share a kernel. If `fine` is true, smaller
    /// ellipses are rounded in finer steps, which depend on the size (see fineness_below_px).
    [[nodiscard]] static KernelKey ellipse(const Ellipse& e, bool fine = false);
    /// Number of bits to which a blur matrix is rounded, so that more samples share a kernel. All four
    /// entries of the matrix, which converts lens points to px, are rounded to the same step. It is chosen so
    /// that the largest entry has this many bits.
    static constexpr int map_bits = 6;
    [[nodiscard]] static KernelKey map(const glm::dmat2& map_px, bool fine = false);
    [[nodiscard]] double step_px() const { return std::ldexp(ellipse_step_px, -2 * fineness); }
    /// Rounds the values of this key more coarsely, by a factor of 2^times, so that more samples share one
    /// blur kernel. These values are the size and subpixel position of a blur ellipse, or, if the aperture is
    /// not round, the entries of the blur matrix and the width of the key's image square.
    void coarsen(int times);
    static constexpr int ellipse_bits = 9;
    static constexpr int most_coarsenings = 8;
    /// Returns the size of the blur in bits. This key describes a blur by the sizes of an ellipse or by the
    /// entries of a matrix, which are integers. The result is the number of bits of the largest of these
    /// integers, without its sign.
    [[nodiscard]] int extent_bits() const;
    /// All fields, packed into 128 bits.
    using Packed = std::pair<std::uint64_t, std::uint64_t>;
    struct PackedHash {
        std::size_t operator()(const Packed& key) const noexcept {
            return (key.first ^ key.second * 0xC2B2AE3D27D4EB4FU) * 0x9E3779B97F4A7C15U;
        }
    };
    [[nodiscard]] Packed packed() const;
    friend bool operator==(const KernelKey&, const KernelKey&) = default;

  private:
    [[nodiscard]] static std::int32_t finest(double extent_px);
    void round_to(std::int32_t unit);
    void round_map(int bits);
};

/// The pixels that a blur kernel covers: rows [dy_begin, dy_end) and columns [dx_begin, dx_end), relative to
/// the kernel's position.
struct Reach {
    int dy_begin = 0, dy_end = 0, dx_begin = 0, dx_end = 0;
    void include(const Reach& other);
};

/// Table of blur kernels, which are identified by numbers. First, any thread may request kernels with
/// `number_of`, which returns their numbers. Then `build` computes the kernels. The timing of threads affects
/// the numbers, but not the kernels.
class KernelTable {
  public:
    /// Creates a table that contains no kernels yet. A depth level is one of the depths for which a blur
    /// kernel can be requested.
    /// - `disc_radius_px`: CoC radius, in px, of each depth level; kernel number i is the disc of level i
    /// - `reach`: limits of the kernels; values in farther columns and rows are left out
    /// - `model`: computes the kernels; must outlive this object
    KernelTable(std::vector<double> disc_radius_px, KernelReach reach, const ResponseModel& model);

    /// Returns the number that identifies the blur kernel with the given key. If `build` has not been called
    /// yet, this also requests the kernel, so that `build` will compute it. After `build`, only keys that
    /// were requested before are allowed.
    [[nodiscard]] std::uint32_t number_of(const KernelKey& key);
    /// Requests the blur kernel of a depth level (one of the depths for which this table can contain a
    /// kernel), so that `build` computes it. The kernel is a disc. It belongs to samples at pixel corners, so
    /// its centre has integer coordinates.
    void use_disc(std::uint32_t level) { disc_used_[level].store(true, std::memory_order_relaxed); }
    /// Builds all requested blur kernels, in parallel. Call it once. If the kernels would need more memory
    /// than `memory_limit_bytes`, their sizes are rounded more coarsely, so that more samples share a kernel.
    /// Throws Error(out_of_memory).
    void build(std::size_t memory_limit_bytes = default_memory_bytes);
    static constexpr std::size_t default_memory_bytes = std::size_t{384} << 20;
    /// Frees the table in which number_of finds the number of a blur kernel. Call it after `build`. number_of
    /// must not be called afterwards.
    void forget_keys() { number_of_key_ = {}; }

    [[nodiscard]] const Kernel& kernel(std::uint32_t number, std::size_t channel) const {
        return kernels_[channels_ * kernel_of_[number] + channel];
    }
    [[nodiscard]] const Kernel& operator[](std::uint32_t number) const { return kernel(number, 0); }
    /// Returns 3 if each colour channel has its own blur kernels, or 1 if all channels share them.
    [[nodiscard]] std::size_t channels() const { return channels_; }
    [[nodiscard]] double disc_radius_px(std::uint32_t level) const { return disc_radius_px_[level]; }
    [[nodiscard]] std::size_t levels() const { return disc_radius_px_.size(); }
    /// Returns the range of pixels that a blur kernel covers, over all its colour channels. `number`
    /// identifies the kernel, as returned by number_of. Call this function after the kernels were computed by
    /// `build`.
    [[nodiscard]] const Reach& reach(std::uint32_t number) const { return reaches_[number]; }
    /// Returns one more than the largest number that identifies a blur kernel. This includes the numbers of
    /// all depth levels (depths for which discs are available). The kernel of such a level does not exist if
    /// no sample uses it. Returns 0 if no kernels have been computed.
    [[nodiscard]] std::size_t numbers() const { return kernels_.empty() ? 0 : kernel_of_.size(); }
    /// Returns how many depth levels have a blur kernel. Call it after `build`.
    [[nodiscard]] int discs_used() const { return discs_used_; }
    /// Returns the ellipse of the blur kernel that `key` identifies. Only for a round aperture.
    [[nodiscard]] Ellipse outline(const KernelKey& key) const;
    /// Returns the 2x2 matrix that converts lens points, in lens radii, to px, for the blur kernel that `key`
    /// identifies. Only for apertures that are not round.
    [[nodiscard]] glm::dmat2 map_px(const KernelKey& key) const;

    /// Returns the approximate memory that a blur kernel needs, in bytes.
    [[nodiscard]] std::size_t bytes_of(const KernelKey& key) const;

  private:
    void coarsen_ellipses(std::size_t memory_limit_bytes);
    [[nodiscard]] Kernel make(const KernelKey& key) const;
    [[nodiscard]] ResponseRequest request(const KernelKey& key) const;
    void make_channels(const std::vector<std::uint32_t>& numbers);

    std::vector<double> disc_radius_px_;
    KernelReach reach_;
    const ResponseModel& model_;
    std::unique_ptr<std::atomic<bool>[]> disc_used_;
    std::mutex mutex_;
    /// Hash of kernel keys for the hash map, which uses only the lowest bits of a hash. In
    /// KernelKey::PackedHash, these bits depend only on a part of the key, the kernel's subpixel position.
    /// Therefore, its upper bits are mixed into the lowest bits.
    struct MixedHash {
        std::size_t operator()(const KernelKey::Packed& key) const noexcept {
            const std::size_t hash = KernelKey::PackedHash()(key);
            return hash ^ hash >> 32;
        }
    };
    tbb::concurrent_unordered_map<KernelKey::Packed, std::uint32_t, MixedHash> number_of_key_;
    std::deque<KernelKey> keys_;            ///< per number; empty after `build`
    std::vector<Kernel> kernels_;           ///< channels_ kernels per element of kernel_of_
    std::vector<std::uint32_t> kernel_of_;  ///< per number, the index of its kernels divided by channels_
    std::vector<Reach> reaches_;            ///< per number
    std::size_t channels_ = 1;
    bool built_ = false;
    int discs_used_ = 0;
};

/// Finds the number under which a KernelTable stores a blur kernel. All threads share one table, and a search
/// in it is slow. Therefore, each thread has its own KernelNumberCache, which remembers the numbers that it
/// has already found.
class KernelNumberCache {
  public:
    explicit KernelNumberCache(KernelTable& table) : table_(&table), entries_(std::size_t{1} << entry_bits) {}
    [[nodiscard]] std::uint32_t number_of(const KernelKey& key);

  private:
    struct Entry {
        KernelKey::Packed key{~std::uint64_t{0}, 0};
        std::uint32_t number = 0;
    };
    static constexpr int entry_bits = 12;
    KernelTable* table_;
    std::vector<Entry> entries_;
};

}  // namespace postlens
