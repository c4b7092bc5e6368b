// Provides the recorded surfaces from which a light field is drawn. To save memory, a large image is drawn in
// groups of rows, and only the surfaces that appear in one group are read.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "focus/light_field/moving_highlights.h"
#include "focus/responses/node_response.h"
#include "records/sample_file.h"
#include "reproject/patch_field.h"
#include "reproject/patches/patch_sweep.h"
#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// The recorded surfaces. `sheets` contains the surfaces of each recorded instant, cut into squares of 16 x
/// 16 px. `primary` contains, for each instant, the planar parts of the surfaces that are seen directly.
/// `deeper` contains the planar parts of the surfaces that are seen by reflection or transmission.
struct FieldSurfaces {
    std::vector<std::shared_ptr<const TreeSheets>> sheets;
    std::vector<PatchMesh> primary, deeper;

    void add(std::shared_ptr<const TreeSheets> some, const PatchLens& lens);
    /// Makes `field` draw these surfaces.
    void show(PatchField& field) const;
};

using SurfacesVisit = std::function<void(const PatchMesh& primary, const PatchMesh& deeper)>;

/// Estimates how much memory the surfaces of a file need, from a few of its rows. The result is in bytes per
/// surface sample (record) of the file.
[[nodiscard]] double surface_bytes_of_record(const SampleFileReader& file, const PatchLens& lens,
                                             const HighlightRule& rule);
/// Upper bound of the result of surface_bytes_of_record.
inline constexpr double most_surface_bytes_of_record = 400;

/// Reads from a sample file the surfaces that appear in one group of image rows at a time, to save memory.
///
/// Some lens point may see a surface far above or below the row in which it is recorded. The first read keeps
/// these few surfaces in memory. So later reads need only the rows of the file near the group.
class FieldStrips {
  public:
    /// Keeps references to the arguments.
    /// - `lens_box_px`: largest shift of a surface's image, in x and in y, from the lens centre to another
    ///   lens point, in px per 1/m of inverse depth
    /// - `motion`: motion of the highlights; null if nothing moves
    FieldStrips(const SampleFileReader& file, std::size_t instants, PatchLens lens, const HighlightRule& rule,
                const PatchField& views, const glm::dvec2& lens_box_px, const HighlightMotion* motion);

    /// Reads from the sample file the surfaces that appear in the rows [y_begin, y_end) of the raster, the
    /// pixel grid of the file. A surface is included if it appears there from any point of the lens.
    [[nodiscard]] FieldSurfaces read(int y_begin, int y_end);
    /// Calls `visit` for all surfaces of a recorded instant. It is called several times, each time with a
    /// part of the surfaces, in any order. Only one thread at a time calls it.
    void visit(std::size_t instant, const SurfacesVisit& visit);
    /// Divides the image into groups of whole rows of tiles, each with at most `most_records` surface
    /// samples. A single row of tiles may exceed this.
    [[nodiscard]] std::vector<std::pair<int, int>> strips(const RasterWindow& window,
                                                          double most_records) const;

  private:
    /// The raster rows [first, last) in which a surface may appear from some lens point. Initially empty.
    struct Reach {
        double first = std::numeric_limits<double>::infinity(), last = -first;
        void include(double from, double to) {
            first = std::min(first, from);
            last = std::max(last, to);
        }
    };
    /// Surfaces that stay in memory between reads, because some lens point sees them many rows above or below
    /// the row in which they are recorded. `primary` contains one range of rows for each surface that is seen
    /// directly: the rows in which the surface may appear. `deeper` contains the same for each surface that
    /// is seen by reflection or transmission.
    struct Far {
        TreeSheets sheets;
        std::vector<Reach> primary, deeper;
    };
    /// A row of raster squares, each 16 px wide.
    struct Row {
        Reach near;  ///< range of rows that the surfaces reach that are not kept
        std::vector<Far> far;
    };
    struct Instant {
        bool known = false;
        std::vector<Row> rows;
    };
    [[nodiscard]] std::vector<Reach> reach_of(const PatchMesh& mesh, std::size_t instant) const;
    void note(const TreeSheets& some, const std::vector<Reach>& primary, const std::vector<Reach>& deeper,
              std::size_t part, int y, Row& row);
    [[nodiscard]] TreeSheets read_some(std::size_t instant, int y_begin, int y_end,
                                       const SurfacesVisit& visit);

    const SampleFileReader& file_;
    PatchLens lens_;
    const HighlightRule& rule_;
    const HighlightMotion* motion_;
    PatchSweep sweep_;
    glm::dvec2 lens_box_px_;
    std::vector<Instant> instants_;
    std::mutex mutex_;
    std::size_t far_bytes_ = 0;  ///< memory of the kept sheets
};

}  // namespace postlens
