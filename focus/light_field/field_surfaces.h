// Provides the surfaces from which a light field is drawn: all surfaces of a file, or those that reach a
// strip of the image.
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

/// The sheets (surfaces within squares of the raster) of each recorded instant, and their planar patches. The
/// patches have references to the sheets.
struct FieldSurfaces {
    std::vector<std::shared_ptr<const TreeSheets>> sheets;
    std::vector<PatchMesh> primary, deeper;

    void add(std::shared_ptr<const TreeSheets> some, const PatchLens& lens);
    /// Sets the instants of `field` to these surfaces.
    void show(PatchField& field) const;
};

using SurfacesVisit = std::function<void(const PatchMesh& primary, const PatchMesh& deeper)>;

/// Estimates the memory of a file's surfaces and patches, bytes per record, by building a few rows of squares
/// of the first instant. Values range from 25 in scenes without reflections to 140 in scenes with many small
/// reflecting objects.
[[nodiscard]] double surface_bytes_of_record(const SampleFileReader& file, const PatchLens& lens,
                                             const HighlightRule& rule);
/// Upper bound of surface_bytes_of_record.
inline constexpr double most_surface_bytes_of_record = 400;

/// Reads the surfaces of an image for one strip (group of rows) after another. Each strip gets the surfaces
/// that reach it in any view. The first read measures how far the surfaces of each row of squares reach, and
/// keeps the few that reach far. For later strips, only the rows close to the strip are read.
class FieldStrips {
  public:
    /// Keeps references to its arguments. `views`: the field of views, without recorded instants. A strip
    /// also gets the surfaces that reach it from any other lens point within views.lens_reach_px.
    /// `lens_box_px`: half the width and height of the lens, in units of LensShift::lens_px, which limits the
    /// reach of highlights. `motion`: motion of highlights; null if no highlight moves.
    FieldStrips(const SampleFileReader& file, std::size_t instants, PatchLens lens, const HighlightRule& rule,
                const PatchField& views, const glm::dvec2& lens_box_px, const HighlightMotion* motion);

    /// The surfaces that reach raster rows [y_begin, y_end).
    [[nodiscard]] FieldSurfaces read(int y_begin, int y_end);
    /// Visits all surfaces of an instant, in parts and in any order. Only one thread at a time calls `visit`.
    void visit(std::size_t instant, const SurfacesVisit& visit);
    /// Divides the window's rows into strips of whole rows of tiles. Each strip has at most `most_records`
    /// records, or a single row of tiles.
    [[nodiscard]] std::vector<std::pair<int, int>> strips(const RasterWindow& window,
                                                          double most_records) const;

  private:
    /// Raster rows [first, last) that a surface reaches; initially empty.
    struct Reach {
        double first = std::numeric_limits<double>::infinity(), last = -first;
        void include(double from, double to) {
            first = std::min(first, from);
            last = std::max(last, to);
        }
    };
    /// Surfaces of neighbouring squares of the raster that views displace far, with the raster rows that each
    /// surface reaches.
    struct Far {
        TreeSheets sheets;
        std::vector<Reach> primary, deeper;
    };
    /// A row of squares of the raster.
    struct Row {
        Reach near;  ///< union of the reaches of the surfaces that are not kept
        std::vector<Far> far;
    };
    struct Instant {
        bool known = false;
        std::vector<Row> rows;
    };
    /// For each sheet (surface within a square of the raster), the raster rows in which views may show it.
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
