// Impulse responses in the form that scattering wants, and the table that builds each one once.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "lens/ellipse_coverage.h"
#include "lens/outline_rows.h"
#include "lens/response_grid.h"

namespace postlens {

/// One row of a kernel, columns relative to the whole coordinate that the splat is anchored at. Pixels of
/// [inner_begin, inner_end) have the kernel's `inner` value; the others of [x_begin, x_end) have taps of
/// their own, left ones first. inner_begin == inner_end == x_end where every pixel has its tap.
struct KernelRow {
    std::int32_t x_begin = 0, inner_begin = 0, inner_end = 0, x_end = 0;
    std::uint32_t tap = 0;  ///< index of the row's first tap
    float sum = 0;          ///< of all its values
};

/// How far a splat's anchor can lie from a pixel of the picture, px: kernels keep columns [-x, x) and rows
/// [-y, y).
struct KernelReach {
    int x = 0, y = 0;
};

/// An impulse response on the pixel grid; its values add up to 1 where `KernelReach` does not cut it.
struct Kernel {
    int y_begin = 0;  ///< of rows.front(), relative to the anchor
    float inner = 0;
    std::vector<KernelRow> rows;
    std::vector<float> taps;
    int x_begin = 0, x_end = 0;  ///< columns over all rows

    [[nodiscard]] int y_end() const { return y_begin + static_cast<int>(rows.size()); }
};

/// The kernel of an ellipse whose centre lies (phase_x, phase_y) px from the anchor. Rows and columns beyond
/// `reach` are left out.
[[nodiscard]] Kernel make_kernel(const Ellipse& ellipse, double phase_x, double phase_y, KernelReach reach);
/// The same of an outline that is placed already, and of a grid, of which every pixel gets a tap.
[[nodiscard]] Kernel make_kernel(const OutlineRows& outline, KernelReach reach);
[[nodiscard]] Kernel make_kernel(const ResponseGrid& grid, KernelReach reach);

class ResponseModel;
struct ResponseRequest;

/// What a splat's kernel is: the shape of its response and where its centre lies between the pixels.
struct KernelKey {
    /// Steps of phases: centres lie on a grid of 1/16 px.
    static constexpr int phase_steps = 16;
    /// Ellipses are told apart in steps of a quarter pixel: no outline is off by more than an eighth in
    /// either axis. Fine ones of less than `fine_below_px` in steps of a sixteenth.
    static constexpr double ellipse_step_px = 0.25, fine_step_px = 0.0625, fine_below_px = 8;
    /// Ellipses reach no farther; beyond, they are scaled down as a whole.
    static constexpr double largest_ellipse_px = 16000;

    bool is_disc = true;
    bool is_fine = false;
    std::uint32_t level = 0;                                             ///< of a disc
    std::int32_t half_height = 0, half_chord = 0, top_displacement = 0;  ///< of an ellipse, in steps
    std::int32_t phase_x = 0, phase_y = 0;                               ///< in 1/phase_steps px, -16..16

    // Only where the aperture is not round, or not the same all over the field:
    bool is_map = false;  ///< then the three numbers above and this one are the map's columns, in steps
    std::int32_t map_yy = 0;
    bool upside_down = false;             ///< a disc before the focus
    std::int32_t cell_x = 0, cell_y = 0;  ///< of the field, from the picture's middle
    std::int32_t cell_log2 = 0;           ///< its width is 2^cell_log2 px; 0: one for all

    [[nodiscard]] static KernelKey disc(std::uint32_t level) { return {.level = level}; }
    /// `fine`: of highlights, which a disc that is a few hundredths of itself too wide shows too dark.
    [[nodiscard]] static KernelKey ellipse(const Ellipse& e, bool fine = false);
    /// Maps are told apart by so many leading bits of their largest number, and by no less than a step.
    static constexpr int map_bits = 6;
    [[nodiscard]] static KernelKey map(const glm::dmat2& map_px, bool fine = false);
    [[nodiscard]] double step_px() const { return is_fine ? fine_step_px : ellipse_step_px; }
    /// A shape for several of its like. An ellipse keeps `ellipse_bits` - `times` leading bits of its largest
    /// number, or as many fewer than it has, the others in the same steps, and its phase in half of these; a
    /// map as many fewer than map_bits, and as many times twice the place in the field. 0: as it is.
    void coarsen(int times);
    static constexpr int ellipse_bits = 9;
    static constexpr int most_coarsenings = 8;
    /// Of its largest number, in steps: its octave.
    [[nodiscard]] int extent_bits() const;
    /// All fields in 128 bits.
    using Packed = std::pair<std::uint64_t, std::uint64_t>;
    struct PackedHash {
        std::size_t operator()(const Packed& key) const noexcept {
            return (key.first ^ key.second * 0xC2B2AE3D27D4EB4FU) * 0x9E3779B97F4A7C15U;
        }
    };
    [[nodiscard]] Packed packed() const;
    friend bool operator==(const KernelKey&, const KernelKey&) = default;

  private:
    void round_to(std::int32_t unit);
    void round_map(int bits);
};

/// Kernels by number. Numbers are given out by any thread at any time; `build` then makes all that were asked
/// for. Which number a key gets depends on timing, what it stands for does not.
class KernelTable {
  public:
    /// `disc_radius_px`: the radius of each level. Discs of level i with phase (0, 0) have the number i.
    /// `model`: whose responses these are; must outlive the table.
    KernelTable(std::vector<double> disc_radius_px, KernelReach reach, const ResponseModel& model);

    /// After build: of keys that were asked for before.
    [[nodiscard]] std::uint32_t number_of(const KernelKey& key);
    /// Marks the phase (0, 0) disc of a level as needed.
    void use_disc(std::uint32_t level) { disc_used_[level].store(true, std::memory_order_relaxed); }
    /// Makes the kernels, in parallel; to be called once, after the last number_of of a key that is new.
    /// Where those of ellipses would take more than `memory_limit_bytes`, they are coarsened, octave by
    /// octave of their size: each time that octave which gives most bytes for what it loses. Throws
    /// Error(out_of_memory) where all together would take more than there is.
    void build(std::size_t memory_limit_bytes = default_memory_bytes);
    static constexpr std::size_t default_memory_bytes = std::size_t{384} << 20;
    /// After build, where no number will be asked for any more.
    void forget_keys() { number_of_key_ = {}; }

    /// `channel` below channels().
    [[nodiscard]] const Kernel& kernel(std::uint32_t number, std::size_t channel) const {
        return kernels_[channels_ * kernel_of_[number] + channel];
    }
    [[nodiscard]] const Kernel& operator[](std::uint32_t number) const { return kernel(number, 0); }
    /// 3 where each colour has its own kernels, else 1 for all.
    [[nodiscard]] std::size_t channels() const { return channels_; }
    [[nodiscard]] double disc_radius_px(std::uint32_t level) const { return disc_radius_px_[level]; }
    [[nodiscard]] std::size_t levels() const { return disc_radius_px_.size(); }
    /// How many numbers there are; after build, which makes those of discs that nobody uses another kernel's.
    [[nodiscard]] std::size_t numbers() const { return kernels_.empty() ? 0 : kernel_of_.size(); }
    /// How many levels have a kernel, of any phase; after build.
    [[nodiscard]] int discs_used() const { return discs_used_; }
    /// The outline that a key of a round aperture stands for.
    [[nodiscard]] Ellipse outline(const KernelKey& key) const;
    /// The map from the aperture to px that a key of another aperture stands for.
    [[nodiscard]] glm::dmat2 map_px(const KernelKey& key) const;

    /// What a kernel of this key takes, about.
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
    std::unordered_map<KernelKey::Packed, std::uint32_t, KernelKey::PackedHash> number_of_key_;
    std::deque<KernelKey> keys_;            ///< by number; until build
    std::vector<Kernel> kernels_;           ///< by place and channel
    std::vector<std::uint32_t> kernel_of_;  ///< by number: the place of its kernels
    std::size_t channels_ = 1;
    bool built_ = false;
    int discs_used_ = 0;
};

/// A direct-mapped memory of recent keys, so that a thread seldom asks the shared table.
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
