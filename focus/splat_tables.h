// Records turned into splats: what is scattered, sorted by source row, apart from how it is scattered.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "focus/border_radii.h"
#include "focus/depth_levels.h"
#include "focus/frame.h"
#include "focus/kernel.h"
#include "focus/node_response.h"
#include "focus/pixel_light.h"
#include "focus/plain_corners.h"
#include "focus/response_model.h"
#include "focus/strip_rows.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// How far splats of the source can lie from pixels of the picture.
[[nodiscard]] KernelReach kernel_reach(const RasterWindow& source, const RasterWindow& picture);

/// A node of one point sample. Its colour is already times the sample's weight; `weight` itself is 0 for
/// deeper nodes, as the normalisation counts point samples.
struct Splat {
    std::int32_t x = 0;  ///< anchor column; the row is that of its SplatRow
    std::uint32_t kernel = 0;
    float r = 0, g = 0, b = 0, weight = 0;
};

/// Neighbouring corner samples [begin, end) of weight one that share a disc; their colours stand in the
/// raster.
struct SplatRun {
    std::int32_t begin = 0, end = 0;
    std::uint32_t kernel = 0;
};

/// Pixels that a response may reach, relative to its anchor: rows [dy_begin, dy_end), columns [dx_begin,
/// dx_end).
struct Reach {
    int dy_begin = 0, dy_end = 0, dx_begin = 0, dx_end = 0;
    void include(const Reach& other);
};

/// Splats are kept apart by how far they reach: one giant circle in a row must not make every block of the
/// picture look at all the small ones.
inline constexpr std::size_t reach_classes = 6;
[[nodiscard]] std::size_t reach_class(const Reach& reach);

struct SplatRow {
    std::vector<SplatRun> runs;  ///< by column
    std::vector<Splat> splats;   ///< by reach class, each by column
    /// Class c is splats [class_begin[c], class_begin[c + 1]); together they reach class_reach[c].
    std::array<std::uint32_t, reach_classes + 1> class_begin{};
    std::array<Reach, reach_classes> class_reach{};
    /// Rows that runs may reach, relative to their own.
    int run_dy_begin = 0, run_dy_end = 0;

    [[nodiscard]] std::span<const Splat> splats_of(std::size_t reach_class) const {
        return std::span(splats).subspan(class_begin[reach_class],
                                         class_begin[reach_class + 1] - class_begin[reach_class]);
    }
};

/// Filled by bands of records in any order, each row once; then finished; then scattered.
class SplatTables {
  public:
    /// `source`: the recorded corners. `picture`: the pixels that will be asked for. `response`: none: discs.
    SplatTables(const RasterWindow& source, const RasterWindow& picture, const FocusGeometry& geometry,
                const DepthLevels& levels, DepthModel model,
                std::shared_ptr<const ResponseModel> response = nullptr);
    ~SplatTables();
    SplatTables(const SplatTables&) = delete;
    SplatTables& operator=(const SplatTables&) = delete;
    SplatTables(SplatTables&&) = delete;
    SplatTables& operator=(SplatTables&&) = delete;

    /// Takes in the corner rows [y_begin, y_end), in parallel. `band` must hold one row more above and below,
    /// where the source window has one. Throws Error(invalid_input) for a damaged quadtree.
    void add_rows(const RecordBand& band, int y_begin, int y_end) {
        add_rows({&band, y_begin, y_end, {}, {}});
    }
    /// The same for rows whose point samples may be known.
    void add_rows(const FrameRows& rows);
    /// Takes in row y of pixels instead, by growing column; safe for several rows at once. What is hidden is
    /// left out.
    void add_pixels(int y, std::span<const PixelLight> lights);
    /// For each pixel of the picture, row by row: how much of it nothing may fill where less than one
    /// arrives. Without, what arrives is all there is.
    void let_nothing_fill(std::vector<float> most) { nothing_ = std::move(most); }
    /// Makes the kernels; after the last row.
    void finish();

    /// For pictures whose splats would take more memory than there is to be spent. Before the first row: what
    /// is added up to finish() tells of responses and runs only.
    void survey() { keep_ = Keep::none; }
    /// After finish(), any number of times: the splats that reach `part`, raster px, are to be kept. Returns
    /// the runs of rows [begin, end) that are then to be added again, in this order, before finish_strip():
    /// at first all. `block_px`: of which the parts will be made; the same for all.
    [[nodiscard]] std::vector<std::pair<int, int>> begin_strip(const RasterWindow& part, int block_px);
    void finish_strip();
    /// After a first strip, of nothing: how many reach rows [begin, end) of blocks.
    [[nodiscard]] std::uint64_t splats_reaching(int begin, int end) const {
        return strip_rows_.reaching(begin, end);
    }

    [[nodiscard]] const RasterWindow& source() const { return source_; }
    [[nodiscard]] const RasterWindow& picture() const { return picture_; }
    [[nodiscard]] const SplatRow& row(int y) const {
        return rows_[static_cast<std::size_t>(y - source_.y_begin)];
    }
    /// Colour `channel` (0..2) of the corners of row y, first at x_begin; meaningful inside the row's runs.
    [[nodiscard]] const float* raster_row(int channel, int y) const {
        return raster_[channel].get() +
               static_cast<std::size_t>(y - source_.y_begin) * static_cast<std::size_t>(source_.width());
    }
    /// Rows that runs, and the splats of a class, may reach from their own, over all rows.
    [[nodiscard]] int run_dy_begin() const { return run_dy_begin_; }
    [[nodiscard]] int run_dy_end() const { return run_dy_end_; }
    [[nodiscard]] const Reach& class_reach(std::size_t reach_class) const {
        return class_reach_[reach_class];
    }
    [[nodiscard]] const KernelTable& kernels() const { return kernels_; }
    /// See let_nothing_fill; of row y of the picture, raster px; none: none anywhere.
    [[nodiscard]] const float* nothing_row(int y) const {
        return nothing_.empty() ? nullptr
                                : nothing_.data() + static_cast<std::size_t>(y - picture_.y_begin) *
                                                        static_cast<std::size_t>(picture_.width());
    }
    [[nodiscard]] const BorderRadii& border() const { return border_; }
    /// Greatest diameter of the CoC among what is seen and was hit, px, as it is, not as its level has it.
    [[nodiscard]] double largest_coc_px() const;
    /// How many discs of different radius are in use.
    [[nodiscard]] int levels_used() const { return kernels_.discs_used(); }
    /// False where no colour is below zero: then no pixel may be.
    [[nodiscard]] bool any_negative() const { return any_negative_; }

  private:
    class RowBuilder;
    struct Builders;
    enum class Keep : std::uint8_t { all, none, strip };
    [[nodiscard]] const Reach& reach_of(const Splat& splat) const { return reach_[splat.kernel]; }
    void find_reaches();
    [[nodiscard]] bool reaches_strip(const Splat& splat, const Reach& reach, int y) const;
    void sort_by_reach(SplatRow& row) const;
    void sort_rows();

    Keep keep_ = Keep::all;
    RasterWindow strip_;           ///< raster px
    StripRows<Splat> strip_rows_;  ///< while there are strips
    RasterWindow source_, picture_;
    NodeResponses responses_;
    KernelTable kernels_;
    std::unique_ptr<Builders>
        builders_;              ///< by thread, while rows are added: what one knows serves its next rows
    std::vector<Reach> reach_;  ///< by number of kernel
    /// Planes of the source; what belongs to no run was never written.
    std::array<std::unique_ptr<float[]>, 3> raster_;
    std::vector<SplatRow> rows_;
    std::vector<float> nothing_;  ///< by pixel of the picture; empty: none
    BorderRadii border_;
    std::vector<double> row_largest_radius_px_;  ///< by row
    std::vector<std::uint8_t> row_negative_;     ///< by row
    bool any_negative_ = false;
    int run_dy_begin_ = 0, run_dy_end_ = 0;
    std::array<Reach, reach_classes> class_reach_{};
};

}  // namespace postlens
