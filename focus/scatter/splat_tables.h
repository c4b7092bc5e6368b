// Converts samples to splats (samples with their blur kernels), sorted by row, as input of the method
// `scatter`.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "focus/frame.h"
#include "focus/responses/depth_levels.h"
#include "focus/responses/kernel.h"
#include "focus/responses/node_response.h"
#include "focus/responses/response_model.h"
#include "focus/scatter/border_radii.h"
#include "focus/scatter/pixel_light.h"
#include "focus/scatter/plain_corners.h"
#include "focus/scatter/strip_rows.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Returns the largest size that a blur kernel needs, in px along each axis: the largest distance between any
/// sample and any pixel of the image.
/// - `source`: window of the samples
/// - `picture`: window of the image's pixels
[[nodiscard]] KernelReach kernel_reach(const RasterWindow& source, const RasterWindow& picture);

/// One contribution to the blurred image: a colour and the blur kernel that spreads it. A sample becomes one
/// splat, or several if a reflection or refraction needs another blur kernel. Such additional splats have the
/// `weight` 0, so that the sample counts only once.
struct Splat {
    std::int32_t x = 0;  ///< anchor column; the row is that of its SplatRow
    std::uint32_t kernel = 0;
    float r = 0, g = 0, b = 0, weight = 0;
};

/// A run: adjacent samples in one row that can be blurred together, because they have the weight 1 and the
/// same blur kernel, a disc. They lie at the pixel corners in the columns [begin, end). Their colours are
/// stored in SplatTables::raster_row.
struct SplatRun {
    std::int32_t begin = 0, end = 0;
    std::uint32_t kernel = 0;
};

/// Number of classes into which the samples of each row are sorted, by the size of their blur kernel. Only
/// the classes with large kernels reach a block of pixels far from the row, so the others are skipped there.
inline constexpr std::size_t reach_classes = 6;
[[nodiscard]] std::size_t reach_class(const Reach& reach);

struct SplatRow {
    std::vector<SplatRun> runs;  ///< sorted by column
    std::vector<Splat> splats;   ///< sorted by reach class, then by column
    /// The samples in `splats` are sorted into classes by the size of their blur kernel. Class c consists of
    /// the elements [class_begin[c], class_begin[c + 1]) of `splats`. class_reach[c] is the range of pixels
    /// that the kernels of class c cover, relative to the sample.
    std::array<std::uint32_t, reach_classes + 1> class_begin{};
    std::array<Reach, reach_classes> class_reach{};
    int run_dy_begin = 0, run_dy_end = 0;

    [[nodiscard]] std::span<const Splat> splats_of(std::size_t reach_class) const {
        return std::span(splats).subspan(class_begin[reach_class],
                                         class_begin[reach_class + 1] - class_begin[reach_class]);
    }
};

/// The samples of an image with their blur kernels, stored by row. Add each row of samples once, in any
/// order, and then call finish().
class SplatTables {
  public:
    /// Creates an object without samples. They are added by add_rows or add_pixels.
    /// - `source`: window of the samples, which lie at pixel corners
    /// - `picture`: window of the pixels of the blurred image
    /// - `response`: computes the blur kernels; if it is null, they are discs and ellipses
    SplatTables(const RasterWindow& source, const RasterWindow& picture, const FocusGeometry& geometry,
                const DepthLevels& levels, DepthModel model,
                std::shared_ptr<const ResponseModel> response = nullptr);
    ~SplatTables();
    SplatTables(const SplatTables&) = delete;
    SplatTables& operator=(const SplatTables&) = delete;
    SplatTables(SplatTables&&) = delete;
    SplatTables& operator=(SplatTables&&) = delete;

    /// Adds the samples in the rows [y_begin, y_end) of pixel corners. A sample in row y lies at the upper
    /// edge of pixel row y, or inside this row. Throws Error(invalid_input) for a damaged quadtree.
    /// - `band`: the records (surface points) of these rows and of one more row above and below
    void add_rows(const RecordBand& band, int y_begin, int y_end) {
        add_rows({&band, y_begin, y_end, {}, {}});
    }
    void add_rows(const FrameRows& rows);
    /// Adds row y of an image that another program made. `lights` are the samples of this row, sorted by
    /// column; those marked as hidden are skipped. Several threads may add different rows.
    void add_pixels(int y, std::span<const PixelLight> lights);
    /// Allows empty space ("nothing"), which is black, to show in the image, where the weights of the samples
    /// in a pixel add up to less than 1. `most` contains for each pixel, row by row, the largest fraction
    /// that empty space may fill.
    void let_nothing_fill(std::vector<float> most) { nothing_ = std::move(most); }
    /// Computes the blur kernels that the added samples need. Call it after all samples have been added, by
    /// add_rows or add_pixels.
    void finish();

    /// A large image is computed in strips (groups of rows), to save memory. For this, first call survey(),
    /// add all samples and call finish(), to find the blur kernels. Then, for each strip, call begin_strip(),
    /// add once more the rows of samples that it returns, and call finish_strip().
    void survey() { keep_ = Keep::none; }
    /// Prepares to compute `part`, a strip (group of rows) of the image. Returns the ranges [begin, end) of
    /// rows of samples whose blur reaches the strip. These rows must be added again before finish_strip().
    /// - `block_px`: height, in rows, of the blocks for which splats_reaching() counts samples
    [[nodiscard]] std::vector<std::pair<int, int>> begin_strip(const RasterWindow& part, int block_px);
    void finish_strip();
    /// Returns how many samples are blurred into the blocks of rows from `begin` to `end` (exclusive), to
    /// estimate the memory that they need. A block has `block_px` rows, as given to begin_strip(). Call this
    /// function after finish_strip().
    [[nodiscard]] std::uint64_t splats_reaching(int begin, int end) const {
        return strip_rows_.reaching(begin, end);
    }

    [[nodiscard]] const RasterWindow& source() const { return source_; }
    [[nodiscard]] const RasterWindow& picture() const { return picture_; }
    [[nodiscard]] const SplatRow& row(int y) const {
        return rows_[static_cast<std::size_t>(y - source_.y_begin)];
    }
    /// Returns one colour channel (0 to 2) of the samples in row y: an array with one value for each pixel
    /// corner. Only the values of samples in runs (SplatRun) are valid, because all other samples have their
    /// colours in their splats (Splat).
    [[nodiscard]] const float* raster_row(int channel, int y) const {
        return raster_[channel].get() +
               static_cast<std::size_t>(y - source_.y_begin) * static_cast<std::size_t>(source_.width());
    }
    /// Range of rows that the blur of runs covers. A run (SplatRun) consists of adjacent samples in one row
    /// that share a blur kernel, a disc. Relative to the samples' row, the discs of all runs lie in the rows
    /// from run_dy_begin() to run_dy_end() (exclusive).
    [[nodiscard]] int run_dy_begin() const { return run_dy_begin_; }
    [[nodiscard]] int run_dy_end() const { return run_dy_end_; }
    [[nodiscard]] const Reach& class_reach(std::size_t reach_class) const {
        return class_reach_[reach_class];
    }
    [[nodiscard]] const KernelTable& kernels() const { return kernels_; }
    /// Returns, for each pixel in row y, an upper bound of the fraction that may show empty space. Returns
    /// null if no pixel may show empty space.
    [[nodiscard]] const float* nothing_row(int y) const {
        return nothing_.empty() ? nullptr
                                : nothing_.data() + static_cast<std::size_t>(y - picture_.y_begin) *
                                                        static_cast<std::size_t>(picture_.width());
    }
    [[nodiscard]] const BorderRadii& border() const { return border_; }
    /// Returns the largest CoC diameter, in px, of all directly visible surfaces at a finite depth. This is
    /// the exact diameter. For blurring, diameters are rounded to a limited number of values.
    [[nodiscard]] double largest_coc_px() const;
    /// Returns how many different radii the samples' blur discs have.
    [[nodiscard]] int levels_used() const { return kernels_.discs_used(); }
    /// Returns whether any sample has a negative colour. If none has, the blurred image cannot be negative.
    /// Negative pixel values are then rounding errors, and can be set to 0.
    [[nodiscard]] bool any_negative() const { return any_negative_; }
    [[nodiscard]] const NodeResponses& responses() const { return responses_; }

  private:
    class RowBuilder;
    struct Builders;
    enum class Keep : std::uint8_t { all, none, strip };
    [[nodiscard]] const Reach& reach_of(const Splat& splat) const { return kernels_.reach(splat.kernel); }
    [[nodiscard]] bool reaches_strip(const Splat& splat, const Reach& reach, int y) const;
    void sort_by_reach(SplatRow& row) const;
    void sort_rows();

    Keep keep_ = Keep::all;
    RasterWindow strip_;           ///< raster px
    StripRows<Splat> strip_rows_;  ///< only used with strips
    RasterWindow source_, picture_;
    NodeResponses responses_;
    KernelTable kernels_;
    std::unique_ptr<Builders> builders_;  ///< per thread, while rows are added; keep caches between rows
    std::array<std::unique_ptr<float[]>, 3> raster_;
    std::vector<SplatRow> rows_;
    std::vector<float> nothing_;  ///< per pixel of the image; may be empty
    BorderRadii border_;
    std::vector<double> row_largest_radius_px_;  ///< per row
    std::vector<std::uint8_t> row_negative_;     ///< per row
    bool any_negative_ = false;
    int run_dy_begin_ = 0, run_dy_end_ = 0;
    std::array<Reach, reach_classes> class_reach_{};
};

}  // namespace postlens
