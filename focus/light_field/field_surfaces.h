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

/// The surfaces of a sample file. Each vector has one element for each recorded instant.
/// - `sheets`: the surfaces, cut into squares of 16 x 16 px
/// - `primary`: the surfaces that are seen directly, approximated by planes
/// - `deeper`: the same for surfaces that are seen by reflection or transmission
struct FieldSurfaces {
    std::vector<std::shared_ptr<const TreeSheets>> sheets;
    std::vector<PatchMesh> primary, deeper;

    void add(std::shared_ptr<const TreeSheets> some, const PatchLens& lens);
    /// Makes `field` draw these surfaces.
    void show(PatchField& field) const;
};

using SurfacesVisit = std::function<void(const PatchMesh& primary, const PatchMesh& deeper)>;

/// Estimates, from a few rows of a file, how much memory its surfaces need when they are prepared for
/// drawing. The result is in bytes per record (surface sample) of the file.
[[nodiscard]] double surface_bytes_of_record(const SampleFileReader& file, const PatchLens& lens,
                                             const HighlightRule& rule);
/// Upper bound of the result of surface_bytes_of_record.
inline constexpr double most_surface_bytes_of_record = 400;

/// Reads from a sample file the surfaces that appear in one group of image rows at a time, to save memory.
/// Most of them are recorded in rows near the group. The few that are recorded farther away stay in memory
/// after the first read.
class FieldStrips {
  public:
    /// The object keeps references to `file`, `rule`, `views` and `motion`.
    /// - `lens_box_px`: how far a surface's image shifts, in x and in y, if the lens point moves from the
    ///   lens's centre to its rim; in px, per 1/m of difference in inverse depth from the focus
    /// - `motion`: motion of the highlights; null if nothing moves
    FieldStrips(const SampleFileReader& file, std::size_t instants, PatchLens lens, const HighlightRule& rule,
                const PatchField& views, const glm::dvec2& lens_box_px, const HighlightMotion* motion);

    /// Reads from the sample file the surfaces that appear in the rows [y_begin, y_end) of the raster, the
    /// pixel grid of the file. A surface is included if it appears there from any point of the lens.
    [[nodiscard]] FieldSurfaces read(int y_begin, int y_end);
    /// Passes all surfaces that the file records at one instant to the function `visit`. To save memory,
    /// `visit` is called several times, each time with a part of the surfaces, in any order. Only one thread
    /// at a time calls it.
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
    /// The surfaces that stay in memory while the image is drawn in groups of rows, because some lens points
    /// see them far away from the row in which they are recorded.
    /// - `primary`: for each surface that is seen directly, the rows in which it may appear
    /// - `deeper`: the same for surfaces that are seen by reflection or transmission
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
