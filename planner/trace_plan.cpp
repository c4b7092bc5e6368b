#include "planner/trace_plan.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

#include "core/counted.h"
#include "core/error.h"
#include "core/files/scratch_file.h"
#include "core/text.h"
#include "focus/frame.h"
#include "focus/responses/depth_levels.h"
#include "lens/focus_geometry.h"
#include "planner/auto_picture.h"
#include "planner/errors/edge_cells.h"
#include "planner/errors/record_floor.h"
#include "planner/views/tile_grid.h"
#include "records/quadtree.h"
#include "records/sample_file.h"
#include "tracer/recording/small_things.h"
#include "tracer/shading_trees/lens_reach.h"

namespace postlens {
namespace {

constexpr int coarser = 4;      ///< width of a preview pixel, in pixels of the trace
constexpr int look_levels = 2;  ///< levels of the preview; its finest cells are as wide as trace pixels
constexpr int most_levels = 6;
/// Fraction of the image's tiles that must reach the target error. The plan chooses the coarsest quadtree
/// subdivision for which two conditions are predicted to hold: the mean error of the whole image reaches the
/// target, and so do the errors of this fraction of its tiles.
constexpr double tiles_met = 0.9;
/// Mean number of eye rays that are added when a quadtree cell is divided into four. There are five new
/// corners, but those on the sides of the cell may already have been traced for the neighbouring cells.
constexpr double samples_per_split = 3.5;

using ByLevel = std::array<double, most_levels + 1>;

struct Look {
    double edge_pixels = 0;  ///< pixels of the trace that an edge crosses, including the overscan
    /// For each tile of the image and each number of quadtree levels: the predicted squared error of sRGB
    /// values, summed over the pixels of the tile.
    std::vector<ByLevel> tiles;
    TileGrid grid;                                ///< tiles of the trace's image
    double samples = 0, records = 0, hidden = 0;  ///< numbers of samples, visible records and hidden records
    double pixels = 0;                            ///< area with overscan, in pixels of the trace
};

std::optional<FocusGeometry> geometry_of(const TraceSettings& s, const CameraModel& camera) {
    if (!s.for_f_number || !s.for_focus_m || camera.projection != Camera::Projection::perspective)
        return std::nullopt;
    return focus_geometry({camera.film_distance_mm, *s.for_f_number}, *s.for_focus_m, Framing::keep,
                          {camera.film_distance_mm, camera.pixel_pitch_mm});
}

Look look_at(const SampleFileReader& file, const FocusGeometry& of_trace) {
    Look out;
    const SampleHeader& h = file.header();
    out.pixels =
        static_cast<double>(h.width + 2 * h.overscan_px) * (h.height + 2 * h.overscan_px) * coarser * coarser;
    out.grid = {h.width * coarser, h.height * coarser};
    out.tiles.resize(out.grid.count(), ByLevel{});
    FocusFrame frame(file);
    // Width of a pixel of the planned trace, in pixels of the preview. The preview is a faster trace of the
    // same scene, whose pixels are `coarser` times as wide. All lengths in its file are in its own pixels.
    constexpr double px = 1.0 / coarser;
    const int last = file.y_end() - 1;  // the last row of samples has no pixels below it
    frame.visit_rows(file.y_begin(), file.y_end(), [&](const FrameRows& rows) {
        const int begin = rows.y_begin, end = std::min(rows.y_end, last);
        if (begin >= end) return;
        PixelLeaves leaves;
        find_leaves(*rows.band, begin, end, leaves);
        std::vector<CellCorner> corners;
        corners.reserve(leaves.points.samples.size());
        for (const PointSample& s : leaves.points.samples) {
            corners.push_back(cell_corner(*rows.band, s));
            if (s.record_count > 0) ++out.samples;
            for (std::uint32_t k = s.first_record; k < s.first_record + s.record_count; ++k)
                ++(rows.band->records[k].layer == 0 ? out.records : out.hidden);
        }
        for (std::size_t pixel = 0; pixel + 1 < leaves.leaf_offsets.size(); ++pixel) {
            double squares = 0;
            bool slants = false;
            double coc_px = std::numeric_limits<double>::infinity();
            ByLevel error{};
            for (std::uint32_t l = leaves.leaf_offsets[pixel]; l < leaves.leaf_offsets[pixel + 1]; ++l) {
                const Leaf& leaf = leaves.leaves[l];
                if (static_cast<double>(leaf.size) > px) continue;
                std::array<const CellCorner*, 4> at{};
                for (std::size_t i = 0; i < 4; ++i) at[i] = &corners[leaf.corner[i]];
                const CellStep step = cell_step(at);
                if (step.split == CellStep::Split::none) continue;
                ++out.edge_pixels;
                squares += step.square;
                slants = slants || step.split == CellStep::Split::slanted;
                for (const CellCorner* c : at)
                    coc_px = std::min(coc_px, std::abs(of_trace.coc_diameter_px(c->inverse_z)));
                // Predicts the error at each quadtree level L. At this level, an edge crosses 2^L cells of
                // the pixel at unknown positions. The errors of their light are independent and proportional
                // to the area of a cell, 4^-L px^2. So the variance is proportional to 2^L (4^-L)^2 = 2^-3L.
                SpreadLight spread;
                spread.add(at, step, 1, of_trace);
                for (int level = 0; level <= most_levels; ++level)
                    error[static_cast<std::size_t>(level)] += spread.error(std::exp2(-3.0 * level));
            }
            const int x = static_cast<int>(pixel) % rows.band->width() + rows.band->x_begin,
                      y = static_cast<int>(pixel) / rows.band->width() + begin;
            if (squares == 0 || x < 0 || y < 0 || x >= h.width || y >= h.height) continue;
            // Predicts the squared error of a pixel that an edge crosses. At quadtree level L, the edge
            // crosses 2^L cells of the pixel. It divides each cell at an unknown position, so each cell's
            // contribution to the pixel has an error that is proportional to the cell's area, 4^-L px^2.
            // - If the edge is parallel to the cells, it divides all of them at the same position. So their
            //   errors are equal and add up, and the squared error is proportional to (2^L 4^-L)^2 = 2^-2L.
            // - If the edge is slanted, the errors are independent. So their squares add up: 2^L (4^-L)^2 =
            //   2^-3L.
            const double one_cell = (slants ? edge_cell_variance : aligned_cell_variance) * squares /
                                    averaged_by(coc_px, !slants);
            ByLevel& to = out.tiles[out.grid.at(x * coarser, y * coarser)];
            for (int level = 0; level <= most_levels; ++level) {
                const auto l = static_cast<std::size_t>(level);
                to[l] += floor_unseen * (error[l] + one_cell * std::exp2((slants ? -3.0 : -2.0) * level));
            }
        }
    });
    return out;
}

}  // namespace

TracePlan plan_trace(const Scene& scene, const TraceSettings& asked, double target_db, bool for_rays) {
    if (!(target_db >= 10 && target_db <= 80))
        fail(ExitCode::wrong_arguments, "--target-db: out of range (got {}; expected 10 to 80)", target_db);
    const bool lens = asked.for_f_number && asked.for_focus_m;
    if (!lens && !asked.for_shutter) {
        fail(ExitCode::wrong_arguments,
             "--plan: for which lens or shutter? (got neither; expected --for-f-number with --for-focus, or "
             "--for-shutter)");
    }
    TracePlan out;
    out.settings = asked;
    out.settings.subdivide_for_lens = false;
    out.settings.overscan_auto = true;
    if (asked.for_shutter) out.settings.keys.reset();

    const Camera& of = find_camera(scene, asked.camera_name);
    const CameraModel camera(of, asked.time_s.value_or(scene.time_s), asked.camera);
    TraceSettings coarse = out.settings;
    coarse.camera.width = std::max(1, camera.width / coarser);
    coarse.camera.height = std::max(1, camera.height / coarser);
    coarse.subdivision.levels = look_levels;
    coarse.share.reset();              // all shares (parts of the work) need the same plan
    coarse.seek_small_things = false;  // narrow objects are estimated below, for the pixels of the trace
    const ScratchFile look_file("look.exr");
    const auto start = std::chrono::steady_clock::now();
    const TraceResult traced = trace_to_file(scene, coarse, look_file.path());
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const SampleFileReader file(look_file.path());
    const FocusGeometry geometry = geometry_of(asked, camera).value_or(FocusGeometry{});
    const Look look = look_at(file, geometry);

    // Chooses the number of quadtree levels. The error of the file, whose samples are sparse at edges, may be
    // half of the squared error at the target. The other half is left to the noise of the image.
    const double most_mse = std::pow(10.0, -target_db / 10) / 2;
    out.levels = -1;
    for (std::size_t level = 0; level <= most_levels; ++level) {
        double sum = 0, met = 0;
        for (std::size_t t = 0; t < look.tiles.size(); ++t) {
            sum += look.tiles[t][level];
            met += look.tiles[t][level] <= most_mse * look.grid.pixels(t) ? 1 : 0;
        }
        const double mse = sum / (static_cast<double>(look.grid.width) * look.grid.height);
        out.floors_db.push_back(-10 * std::log10(std::max(mse, 1e-12)));
        if (out.levels < 0 && mse <= most_mse && met >= tiles_met * static_cast<double>(look.tiles.size()))
            out.levels = static_cast<int>(level);
    }
    if (for_rays) out.levels = TraceSettings::ray_levels;
    out.met = out.levels >= 0;
    if (!out.met) out.levels = most_levels;
    out.floor_db = out.floors_db[static_cast<std::size_t>(out.levels)];
    out.settings.subdivision.levels = out.levels;
    // Area of the image with its overscan, in pixels of the planned trace. The preview's overscan is in
    // pixels of the preview, which are `coarser` times as wide.
    const double window = (camera.width + 2.0 * coarser * traced.overscan_px) *
                          (camera.height + 2.0 * coarser * traced.overscan_px);
    const SmallThings things(scene, ObjectParts(scene), camera, asked.time_s.value_or(scene.time_s), 0,
                             camera.width, 0, camera.height);
    const double samples =
        window * (1 + look.edge_pixels / look.pixels * samples_per_split * (std::exp2(out.levels) - 1)) +
        (out.levels > 0 ? things.cells() / 4 * samples_per_split : 0);
    const DepthRange range = depth_range(file);
    const double reach_px =
        range.nearest_m ? geometry.gain_px * geometry.aperture_radius_m / *range.nearest_m : 0;
    // Hidden surfaces are recorded in a strip beside each edge. `narrower` is the width of this strip divided
    // by its width in the preview. The strip is as wide as `reach_px` plus a margin of some pixels, and the
    // pixels of the preview are `coarser` times as wide.
    const double narrower = (reach_px + LensReach::margin_px) / (reach_px + coarser * LensReach::margin_px);
    out.records = samples * (look.records + (asked.for_shutter ? 1 : narrower) * look.hidden) /
                  std::max(1.0, look.samples) * static_cast<double>(traced.instants_s.size());
    if (lens && !asked.for_shutter && !asked.hidden_layers) {
        // `reach_px` is the largest distance, in px, by which a lens point can shift the image of the nearest
        // surface against that of a far one. For opposite points of the lens, the shifts differ by up to 2 *
        // reach_px. If this is less than half a pixel, the lens sees no visible part of a hidden surface.
        if (2 * reach_px < 0.5) out.settings.hidden_layers = 0;
    }

    out.bytes = out.records * static_cast<double>(traced.bytes) /
                std::max<double>(1, static_cast<double>(traced.records));
    out.seconds = took_s * out.records / std::max<double>(1, static_cast<double>(traced.records));
    out.text = fmt::format(
        "planned: {} of subdivision, overscan {} px or less, hidden surfaces {}, {}: records "
        "good for {:.1f} dB{}; about {} million records, {}, {} s",
        counted(out.levels, "level"), traced.overscan_px * coarser,
        out.settings.hidden_layers == 0 ? "none" : "where they come to light",
        counted(traced.instants_s.size(), "instant"), out.floor_db, for_rays ? " without rays" : "",
        rough(out.records / 1e6), megabytes(out.bytes), rough(out.seconds));
    return out;
}

}  // namespace postlens
