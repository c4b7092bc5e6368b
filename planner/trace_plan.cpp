#include "planner/trace_plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <unistd.h>

#include "core/error.h"
#include "focus/depth_levels.h"
#include "focus/frame.h"
#include "lens/focus_geometry.h"
#include "planner/auto_picture.h"
#include "planner/record_floor.h"
#include "records/quadtree.h"
#include "records/sample_file.h"
#include "records/srgb.h"

namespace postlens {
namespace {

constexpr int coarser = 4;      ///< the look's pixels, in the trace's
constexpr int look_levels = 2;  ///< so that its finest cells are pixels of the trace
constexpr int most_levels = 6;
/// New samples of a cell that is split: its centre and what of the middles of its sides is not there yet.
constexpr double samples_per_split = 3.5;

/// A folder that goes with its contents.
class Scratch {
  public:
    Scratch() {
        std::string name = (std::filesystem::temp_directory_path() / "postlens_plan_XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr)
            fail(ExitCode::cannot_write, "{}: cannot make a folder there", name);
        path_ = name;
    }
    ~Scratch() {
        std::error_code none;
        std::filesystem::remove_all(path_, none);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    Scratch(Scratch&&) = delete;
    Scratch& operator=(Scratch&&) = delete;
    [[nodiscard]] std::filesystem::path file() const { return path_ / "look.exr"; }

  private:
    std::filesystem::path path_;
};

struct Look {
    double edge_pixels = 0;  ///< pixels of the trace that an edge crosses, of the frame
    double error = 0;        ///< sum over them of the squared error that a single cell of a pixel would have
    double samples = 0;
    double pixels = 0;  ///< of the frame, in pixels of the trace
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
    out.pixels = static_cast<double>(h.width) * h.height * coarser * coarser;
    FocusFrame frame(file);
    // Circles of confusion as wide as the trace will have them; a cell of a pixel there is a quarter here.
    constexpr double px = 1.0 / coarser;
    frame.visit_rows(0, h.height + 1, [&](const FrameRows& rows) {
        const int begin = std::max(rows.y_begin, 0), end = std::min(rows.y_end, h.height);
        if (begin >= end) return;
        PixelLeaves leaves;
        find_leaves(*rows.band, begin, end, leaves);
        for (const PointSample& s : leaves.points.samples) {
            if (s.record_count > 0) ++out.samples;
        }
        for (const Leaf& leaf : leaves.leaves) {
            if (static_cast<double>(leaf.size) > px) continue;
            std::array<float, 3> low{1, 1, 1}, high{0, 0, 0};
            double coc_px = 1e30;
            for (const std::uint32_t c : leaf.corner) {
                const PointSample& s = leaves.points.samples[c];
                std::array<float, 3> rgb{};
                for (std::uint32_t k = s.first_record; k < s.first_record + s.record_count; ++k) {
                    const Record& r = rows.band->records[k];
                    if (r.layer != 0) continue;
                    rgb[0] += r.r, rgb[1] += r.g, rgb[2] += r.b;
                    if (r.path.bits() == 0) {
                        const double inverse_z =
                            std::isfinite(r.z) && r.z > 0 ? 1 / static_cast<double>(r.z) : 0;
                        coc_px = std::min(coc_px, std::abs(of_trace.coc_diameter_px(inverse_z)));
                    }
                }
                for (std::size_t i = 0; i < 3; ++i) {
                    low[i] = std::min(low[i], srgb_from_linear(rgb[i]));
                    high[i] = std::max(high[i], srgb_from_linear(rgb[i]));
                }
            }
            double step = 0;
            for (std::size_t i = 0; i < 3; ++i)
                step += static_cast<double>(high[i] - low[i]) * static_cast<double>(high[i] - low[i]) / 3;
            const double averaged = std::max(1.0, std::numbers::pi / 4 * coc_px * coc_px);
            if (step > 0) ++out.edge_pixels;  // of the four quarters of a cell an edge crosses some
            out.error += edge_cell_variance * step / averaged;
        }
    });
    return out;
}

}  // namespace

TracePlan plan_trace(const Scene& scene, const TraceSettings& asked, double target_db) {
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
    coarse.quiet = true;
    const Scratch scratch;
    const auto start = std::chrono::steady_clock::now();
    const TraceResult traced = trace_to_file(scene, coarse, scratch.file());
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const SampleFileReader file(scratch.file());
    const FocusGeometry geometry = geometry_of(asked, camera).value_or(FocusGeometry{});
    const Look look = look_at(file, geometry);

    // Half of what the target allows, so that views have the other half.
    const double most_mse = std::pow(10.0, -target_db / 10) / 2;
    out.levels = -1;
    for (int level = 0; level <= most_levels; ++level) {
        // An edge crosses 2^L cells of a pixel, each with an area of 4^-L whose square its error goes with.
        const double mse = look.error / look.pixels * std::exp2(-3.0 * level);
        out.floors_db.push_back(-10 * std::log10(std::max(mse, 1e-12)));
        if (out.levels < 0 && mse <= most_mse) out.levels = level;
    }
    out.met = out.levels >= 0;
    if (!out.met) out.levels = most_levels;
    out.floor_db = out.floors_db[static_cast<std::size_t>(out.levels)];
    out.settings.subdivision.levels = out.levels;
    if (lens && !asked.for_shutter && !asked.hidden_layers) {
        const DepthRange range = depth_range(file);
        // Whatever lies behind: infinitely far away at most.
        const double parting_px =
            range.nearest_m ? 2 * geometry.gain_px * geometry.aperture_radius_m / *range.nearest_m : 0;
        if (parting_px < 0.5) out.settings.hidden_layers = 0;
    }

    const double frame = look.pixels,
                 o = 2.0 * traced.overscan_px * coarser,  // the look's pixels are wider
        window =
            (camera.width + o) * (camera.height + o) / (static_cast<double>(camera.width) * camera.height);
    const double samples =
        window * (frame + look.edge_pixels * samples_per_split * (std::exp2(out.levels) - 1));
    out.records = samples * static_cast<double>(traced.records) / std::max(1.0, look.samples * window);
    out.bytes = out.records * static_cast<double>(traced.bytes) /
                std::max<double>(1, static_cast<double>(traced.records));
    out.seconds = took_s * out.records / std::max<double>(1, static_cast<double>(traced.records));
    out.text = fmt::format(
        "planned: {} levels of subdivision, overscan {} px or less, hidden surfaces {}, {} instants: records "
        "good for "
        "{:.1f} dB; about {:.2g} million records, {:.2g} MB, {:.2g} s",
        out.levels, traced.overscan_px * coarser,
        out.settings.hidden_layers == 0 ? "none" : "where they come to light", traced.instants_s.size(),
        out.floor_db, out.records / 1e6, out.bytes / 1e6, out.seconds);
    return out;
}

}  // namespace postlens
