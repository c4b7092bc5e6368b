// The surfaces of a file that the views of a light field look at: all of them, or those that reach a strip of
// the picture.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "focus/moving_highlights.h"
#include "focus/node_response.h"
#include "records/sample_file.h"
#include "reproject/patch_field.h"
#include "reproject/patch_sweep.h"
#include "reproject/patches.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

/// By instant; the patches keep references to the sheets.
struct FieldSurfaces {
    std::vector<std::shared_ptr<const TreeSheets>> sheets;
    std::vector<PatchMesh> primary, deeper;

    void add(std::shared_ptr<const TreeSheets> some, const PatchLens& lens);
    /// Into a field, of which they are the instants.
    void show(PatchField& field) const;
};

using SurfacesVisit = std::function<void(const PatchMesh& primary, const PatchMesh& deeper)>;

/// About what the surfaces of a file take for each record, patches and all: of a few rows of squares, evenly
/// spread over the first instant, which are made for it. 25 where there are no mirrors, 140 of many small
/// ones.
[[nodiscard]] double surface_bytes_of_record(const SampleFileReader& file, const PatchLens& lens,
                                             const HighlightRule& rule);
/// No file is expected to take more.
inline constexpr double most_surface_bytes_of_record = 400;

/// Reads the surfaces strip by strip of the picture: of each strip those that reach it in any view. From the
/// first reading it is known how far the surfaces of each row reach; the few that reach far are kept, so that
/// for later strips only their own rows and those close to them have to be read.
class FieldStrips {
  public:
    /// Keeps references to all. `views`: a field without instants; what lenses as far as its lens_reach_px
    /// see is kept as well. `lens_box_px`: half the width and height of the lens, as LensShift::lens_px, for
    /// what highlights reach. `motion`: of highlights; null: none moves.
    FieldStrips(const SampleFileReader& file, std::size_t instants, const PatchLens& lens,
                const HighlightRule& rule, const PatchField& views, const glm::dvec2& lens_box_px,
                const HighlightMotion* motion);

    /// Those of raster rows [y_begin, y_end).
    [[nodiscard]] FieldSurfaces read(int y_begin, int y_end);
    /// Visits the surfaces of a whole instant, some at a time, in any order; from one thread at a time.
    void visit(std::size_t instant, const SurfacesVisit& visit);
    /// Strips of the window's rows, of whole tiles, that have as many records or less, or a row of tiles.
    [[nodiscard]] std::vector<std::pair<int, int>> strips(const RasterWindow& window,
                                                          double most_records) const;

  private:
    /// Rows [first, last) of the raster that something reaches; as made, none.
    struct Reach {
        double first = std::numeric_limits<double>::infinity(), last = -first;
        void include(double from, double to) {
            first = std::min(first, from);
            last = std::max(last, to);
        }
    };
    /// Neighbouring squares' sheets that reach far, with how far each reaches.
    struct Far {
        TreeSheets sheets;
        std::vector<Reach> primary, deeper;
    };
    /// A row of squares.
    struct Row {
        Reach near;  ///< of what is not kept
        std::vector<Far> far;
    };
    struct Instant {
        bool known = false;
        std::vector<Row> rows;
    };
    /// By sheet.
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
    std::size_t far_bytes_ = 0;  ///< kept
};

}  // namespace postlens
