// Converts samples to splats (samples with their blur kernels), grouped by surface, for the method `layers`.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "focus/frame.h"
#include "focus/responses/kernel.h"
#include "focus/responses/node_response.h"
#include "focus/scatter/border_radii.h"
#include "focus/scatter/pixel_light.h"
#include "focus/scatter/splat_tables.h"
#include "focus/scatter/strip_rows.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Identifies one of the surfaces that an eye ray hits. The ray may hit several surfaces of one object.
/// - `id`: number of the object
/// - `before`: how many surfaces of the same object the ray hits in front of this one
struct SurfaceKey {
    std::uint32_t id = 0;
    std::uint32_t before = 0;
    // NOLINTNEXTLINE(modernize-use-nullptr): what is found is the compiler's own comparison with 0
    friend auto operator<=>(const SurfaceKey&, const SurfaceKey&) = default;
};

/// Identifies a group of samples that are blurred and summed together. A group has the samples of one
/// surface, or those of one image that this surface reflects or transmits.
struct LayerPart {
    enum class Kind : std::uint32_t {
        seen,         ///< nodes that the pinhole sees
        hidden,       ///< nodes behind another surface
        mask,         ///< the node's colours, scattered with the kernels of the parent nodes
        hidden_mask,  ///< masks of parent nodes that are hidden behind another surface
        outer_mask,   ///< mask of the far side of glass, scattered with the kernels of the near side
    };
    SurfaceKey surface;      ///< surface of the primary node
    std::uint32_t path = 0;  ///< NodePath::bits; 0 for the surface itself
    /// Identifies the surface that is seen in `surface` after the reflections and refractions `path`. For a
    /// mask, which tells how much of each pixel shows a mirror image, `shown` instead identifies the mirror
    /// or glass that shows the image. `shown` stays empty if this mirror or glass is `surface` itself.
    SurfaceKey shown;
    Kind kind = Kind::seen;
    // NOLINTNEXTLINE(modernize-use-nullptr): as above
    friend auto operator<=>(const LayerPart&, const LayerPart&) = default;
};

/// A sample that will be blurred, or the sum of several merged samples.
/// - `kernel`: index of the blur kernel in LayerSplats::kernels()
/// - `weight`: image area that the sample represents, in px^2, times its alpha and the transmittance of the
///   lens
/// - `r`, `g`, `b`: colour times `weight`
/// - `depth`: inverse depth times `weight`, in 1/m
struct LayerSplat {
    std::int32_t x = 0, y = 0;  ///< anchor
    std::uint32_t kernel = 0;
    float r = 0, g = 0, b = 0, weight = 0, depth = 0;
    /// Factor that estimates through which lens point the sample's light reaches a pixel. Multiplied by the
    /// distance from the centre of the blur kernel to the pixel, in px along x and y, it gives the mean lens
    /// point, in lens radii.
    float lens_per_px = 0;
    /// The part of `weight` that no lens point sees, for a sample that a nearer surface hides from the
    /// pinhole. If this surface lies at nearly the same depth, it moves with the sample when the lens point
    /// moves, and therefore always hides it.
    float covered = 0;
};

/// A run of samples that belong to one surface and lie in one pixel row, within the same square of 64 x 64 px
/// of the image. It has the elements [begin, end) of the list of all samples in the pixel row `row`.
struct LayerRun {
    std::uint32_t row = 0;
    std::uint32_t begin = 0, end = 0;
};

/// All samples of one surface in a square of 64 x 64 px of the image.
struct LayerCell {
    std::uint32_t part = 0;
    std::uint32_t tile_row = 0;
    std::uint32_t begin = 0, end = 0;  ///< range of runs in tile_runs_[tile_row], one run per row
    RasterWindow reach;                ///< pixels that the splats reach
};

/// Smallest and largest radiance of the shading trees, per channel.
struct RadianceRange {
    std::array<float, 3> least{}, most{};
    RadianceRange();
    void include(const std::array<float, 3>& rgb);
    void include(const RadianceRange& other);
};

/// All samples of an image that will be blurred, with their blur kernels. They are grouped by the surface to
/// which they belong, because the method `layers` blurs each surface separately. Add each row of the image
/// once, in any order, and then call finish().
class LayerSplats {
  public:
    /// The arguments are those of SplatTables.
    LayerSplats(const RasterWindow& source, const RasterWindow& picture, const FocusGeometry& geometry,
                const DepthLevels& levels, DepthModel model,
                std::shared_ptr<const ResponseModel> response = nullptr);
    ~LayerSplats();
    LayerSplats(const LayerSplats&) = delete;
    LayerSplats& operator=(const LayerSplats&) = delete;
    LayerSplats(LayerSplats&&) = delete;
    LayerSplats& operator=(LayerSplats&&) = delete;

    /// Adds the surface samples at the pixel corners of the image rows [y_begin, y_end). `band` must contain
    /// the records of these rows and, if the file has them, of the rows directly above and below. Throws
    /// Error(invalid_input) if a pixel's quadtree is damaged.
    void add_rows(const RecordBand& band, int y_begin, int y_end) {
        add_rows({&band, y_begin, y_end, {}, {}});
    }
    /// Adds the surface samples at the pixel corners of the image rows `rows`. If `rows` already contains the
    /// eye rays to which these samples belong, they are used. Otherwise, the eye rays are computed from the
    /// records. Throws as the other add_rows() does.
    void add_rows(const FrameRows& rows);
    /// Prepares these LayerSplats to blur the image of another program, whose samples lie at the centres of
    /// the pixels instead of their corners. Call this function before add_pixels().
    /// - `known`: pixel corners of the area that the image covers; what lies outside is only estimated
    void take_pixels(const RasterWindow& known) {
        from_anchor_px_ = 0.5;
        known_ = known;
        border_ = BorderRadii(known);
    }
    /// Adds row y of another program's image to the samples to be blurred. Several threads may add different
    /// rows at the same time.
    void add_pixels(int y, std::span<const PixelLight> lights);
    /// Builds the blur kernels and sorts the samples by surface. Call it after all rows have been added.
    void finish();

    /// Starts the first of two passes, in which a large image is computed in strips (groups of rows) to save
    /// memory. This pass finds only the surfaces and blur kernels: add all samples, then call finish().
    void survey() { keep_ = Keep::none; }
    /// Starts a strip in the second pass. Returns the ranges of rows whose samples reach the strip. Add these
    /// rows again, then call finish_strip().
    [[nodiscard]] std::vector<std::pair<int, int>> begin_strip(const RasterWindow& part, int block_px);
    void finish_strip();
    [[nodiscard]] std::uint64_t splats_reaching(int begin, int end) const {
        return strip_rows_.reaching(begin, end);
    }

    [[nodiscard]] const RasterWindow& source() const { return source_; }
    [[nodiscard]] const RasterWindow& picture() const { return picture_; }
    [[nodiscard]] const FocusGeometry& geometry() const { return responses_.geometry(); }
    [[nodiscard]] const KernelTable& kernels() const { return kernels_; }
    [[nodiscard]] std::span<const LayerPart> parts() const { return parts_; }
    /// Returns the groups of samples, sorted by surface, then by tile. Each group (LayerCell) has the samples
    /// of one surface in one tile of the image.
    [[nodiscard]] std::span<const LayerCell> cells() const { return cells_; }
    [[nodiscard]] std::span<const LayerRun> runs(const LayerCell& cell) const {
        return std::span(tile_runs_[cell.tile_row]).subspan(cell.begin, cell.end - cell.begin);
    }
    [[nodiscard]] std::span<const LayerSplat> splats(const LayerRun& run) const {
        return std::span(rows_[run.row].splats).subspan(run.begin, run.end - run.begin);
    }
    [[nodiscard]] const BorderRadii& border() const { return border_; }
    [[nodiscard]] double largest_coc_px() const;
    [[nodiscard]] int levels_used() const { return kernels_.discs_used(); }
    /// Returns the distance from a pixel's upper left corner to its sample, in px along both axes. It is 0
    /// for a sample file, because its samples lie at pixel corners, and 0.5 for the image of another program.
    [[nodiscard]] double from_anchor_px() const { return from_anchor_px_; }
    [[nodiscard]] const NodeResponses& responses() const { return responses_; }
    [[nodiscard]] const RadianceRange& colours() const { return colours_; }

  private:
    class RowBuilder;
    struct Builders;
    enum class Keep : std::uint8_t { all, none, strip };
    /// The samples of one surface (`part`) that lie in one pixel row, within the same square of 64 x 64 px.
    struct PlacedRun {
        std::uint32_t part = 0;
        std::uint32_t tile = 0;  ///< column of squares
        LayerRun run;
        [[nodiscard]] auto place() const { return std::tie(part, tile, run.row); }
    };
    struct Row {
        std::vector<LayerPart> parts;
        std::vector<PlacedRun> runs;  ///< PlacedRun::part is an index into `parts`
        std::vector<LayerSplat> splats;
        double largest_radius_px = 0;
        RadianceRange colours;
    };
    struct UnsortedRow {
        std::vector<LayerPart> parts;
        std::vector<std::uint32_t> part;  ///< per sample, index into `parts`
        std::vector<LayerSplat> splats;
        double largest_radius_px = 0;
        RadianceRange colours;
        /// Removes all elements, but keeps the capacity.
        void clear();
    };
    [[nodiscard]] Row sorted(const UnsortedRow& row) const;
    std::vector<LayerCell> join(std::size_t tile_row);
    void join_rows(std::size_t end);
    void sort_cells();
    void begin_tile_rows();
    void find_reach(LayerCell& cell) const;
    void store(int y, UnsortedRow& made);
    [[nodiscard]] RasterWindow reach_of(const LayerSplat& splat) const;

    Keep keep_ = Keep::all;
    RasterWindow strip_;  ///< raster px
    struct PartSplat {
        LayerPart part;
        LayerSplat splat;
    };
    StripRows<PartSplat> strip_rows_;  ///< only used with strips
    RasterWindow source_, picture_, known_;
    NodeResponses responses_;
    KernelTable kernels_;
    std::unique_ptr<Builders> builders_;  ///< those of add_pixels
    BorderRadii border_;
    std::vector<Row> rows_;
    std::vector<LayerPart> parts_;
    std::vector<LayerCell> cells_;
    std::vector<std::vector<LayerRun>> tile_runs_;  ///< each sorted by part, tile and row
    std::size_t joined_ = 0;                        ///< number of complete elements of tile_runs_
    std::vector<std::vector<LayerCell>>
        tile_cells_;  ///< one element per element of tile_runs_; emptied when sorted into cells_
    double largest_radius_px_ = 0;
    double from_anchor_px_ = 0;
    RadianceRange colours_;
};

}  // namespace postlens
