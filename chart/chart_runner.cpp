#include "chart/chart_runner.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "chart/chart_plan.h"
#include "chart/earlier_chart.h"
#include "chart/machine.h"
#include "chart/point_picture.h"
#include "compare/drawing/error_map.h"
#include "core/error.h"
#include "core/files/file_identity.h"
#include "core/files/folder.h"
#include "core/files/output_file.h"
#include "core/files/share_table.h"
#include "core/json_dump.h"
#include "core/progress.h"
#include "core/threads.h"
#include "focus/frame.h"
#include "pictures/exposure.h"
#include "records/sample_file.h"
#include "tracer/exposure.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr int floor_spp = 256;
constexpr std::array own_pictures{"reference.exr", "reference.a.exr", "reference.b.exr",
                                  "reference.partial.exr", "pinhole.exr"};

template <typename Work>
double seconds_of(const Work& work) {
    const auto start = Clock::now();
    work();
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Json about_json(const ChartRequest& r, const ChartView& v, const Scene& scene) {
    Json out{{"scene", r.scene.filename().string()},
             {"scene_sha256", scene.sha256},
             {"width", v.width},
             {"height", v.height},
             {"focal_length_mm", v.lens.focal_length_mm},
             {"film_distance_mm", v.film_distance_mm},
             {"f_number", std::isfinite(v.lens.f_number) ? Json(v.lens.f_number) : Json(nullptr)},
             {"focus_m", v.has_lens() && std::isfinite(v.focus_m) ? Json(v.focus_m) : Json(nullptr)},
             {"shutter_s", v.shutter ? Json{v.shutter->open_s, v.shutter->close_s} : Json(nullptr)},
             {"reference", r.reference ? r.reference->filename().string()
                                       : fmt::format("2 x {} samples a pixel", r.reference_spp)},
             {"exposure_stops", scene.exposure_stops},
             {"threads", thread_count()}};
    out["machine"] = machine_json();
    return out;
}

Scene exposed_scene(const ChartRequest& r) {
    Scene scene = read_scene(r.scene, r.units);
    expose(scene, r.exposure_auto ? auto_exposure_stops(scene, r.camera_name, r.camera) : r.exposure_stops);
    return scene;
}

/// Returns the points of a chart (methods with their settings) that this machine measures, and the sample
/// files from which their images are made. If N machines divide the work (--share), each measures every N-th
/// point.
ChartPlan plan_of(const ChartRequest& r, const ChartView& view) {
    ChartPlan all = chart_plan(r, view);
    if (!r.share) return all;
    if (static_cast<std::size_t>(r.share->count) > all.points.size()) {
        fail(ExitCode::wrong_arguments, "--share: more shares than points (got {}; expected {} or less)",
             r.share->count, all.points.size());
    }
    // The first sample file is always included, because the pinhole image is made from it.
    ChartPlan out;
    for (std::size_t i = 0; i < all.points.size(); ++i)
        if (r.share->has(i)) out.points.push_back(all.points[i]);
    for (PlannedTrace& t : all.traces) {
        const bool needed = std::any_of(out.points.begin(), out.points.end(),
                                        [&](const PlannedPoint& p) { return p.trace == t.name; });
        if (needed || out.traces.empty()) out.traces.push_back(std::move(t));
    }
    return out;
}

class Runner {
  public:
    Runner(const ChartRequest& request, fs::path folder)
        : request_(request),
          folder_(std::move(folder)),
          scene_(exposed_scene(request)),
          view_(chart_view(request, scene_)),
          plan_(plan_of(request, view_)),
          pictures_(request, scene_, view_) {}

    void run(bool restart, ChartRun& out) {
        begin(restart, out);
        std::uint64_t steps = 3;
        steps += static_cast<std::uint64_t>(request_.rounds) * (plan_.traces.size() + plan_.points.size());
        Progress progress("chart", steps);
        // First makes the sample files, by tracing the scene, because most images are made from them. Even
        // `references` below needs one: it makes a pinhole image from it, to find the pixels that blur
        // changes. If this run only joins earlier measurements, it checks that these are complete instead.
        if (request_.join == Join::no)
            for (std::size_t t = 0; t < plan_.traces.size(); ++t) measure_trace(t, 0);
        else
            check_join(out.missing);
        references();
        progress.advance(3);
        for (int round = 0; round < request_.rounds && request_.join == Join::no; ++round) {
            for (std::size_t t = 0; t < plan_.traces.size(); ++t) {
                measure_trace(t, round);
                progress.advance();
            }
            for (const PlannedPoint& p : plan_.points) {
                measure_point(p, round);
                progress.advance();
            }
        }
        std::error_code none;
        fs::remove_all(frames_folder(), none);
        out.data = std::move(data_);
        out.kept = kept_;
        if (other_machine_) out.notes.emplace_back("the times are of several machines");
    }

  private:
    void begin(bool restart, ChartRun& out) {
        out.notes = scene_.notes;
        for (const auto& given : {request_.reference, request_.second_reference}) {
            if (given) check_size(*given, read_image_size(*given));
        }
        check_outputs();
        make_folder(folder_);
        for (const char* name : {"pictures", "maps"}) make_folder(folder_ / name);
        make_folder(frames_folder());
        const std::string key = chart_key(request_, view_, scene_);
        if (!restart || request_.join != Join::no) {
            for (const fs::path& path : earlier_charts(request_, folder_, chart_path()))
                other_machine_ = take_over_chart(path, key, path == chart_path(), data_) || other_machine_;
            for (const ChartPoint& p : data_.points) kept_ += p.seconds.size();
        }
        // Deletes the images that an earlier run of `chart` left in the folder (`own_pictures`), because they
        // may differ from those of this run. They are kept if this run continues the earlier run's
        // measurements, or if another machine that shares the work may have made them.
        if (data_.key.empty() && !request_.share && request_.join == Join::no) {
            std::error_code none;
            for (const char* name : own_pictures) fs::remove(folder_ / name, none);
        }
        data_.key = key;
        data_.about = about_json(request_, view_, scene_);
        data_.part = request_.part.empty() ? Json() : Json::parse(request_.part);
        arrange_by_plan(plan_, data_);
        save();
    }

    void check_join(std::vector<std::string>& missing) {
        for (const ChartPoint& p : data_.points)
            if (!p.figures) missing.push_back(p.name);
        if (!missing.empty() && request_.join == Join::whole) {
            fail(ExitCode::invalid_input,
                 "{}: {} of {} points are missing, e.g. {} (expected all; --partial joins what is there)",
                 folder_.string(), missing.size(), data_.points.size(), missing.front());
        }
        std::erase_if(data_.points, [](const ChartPoint& p) { return !p.figures; });
    }

    // Throws if the results of the command `chart` would overwrite or remove one of its input files.
    void check_outputs() const {
        std::vector<fs::path> read{request_.scene}, written{chart_path()};
        for (const auto& given : {request_.reference, request_.second_reference}) {
            if (given) read.push_back(*given);
        }
        for (const char* name : own_pictures) written.push_back(folder_ / name);
        refuse_overwriting(read, written);
    }

    void check_size(const fs::path& path, const ImageSize& size) const {
        if (size.width == view_.width && size.height == view_.height) return;
        fail(ExitCode::invalid_input, "{}: wrong size (got {}x{}; expected {}x{})", path.string(), size.width,
             size.height, view_.width, view_.height);
    }

    [[nodiscard]] fs::path chart_path() const {
        return folder_ / (request_.share ? share_table_name("chart", *request_.share) : "chart.json");
    }
    [[nodiscard]] fs::path frames_folder() const {
        const auto& share = request_.share;
        return folder_ / (share ? fmt::format("frames.{}-of-{}", share->index, share->count) : "frames");
    }
    [[nodiscard]] fs::path frame_path(const std::string& name) const {
        return frames_folder() / (point_file_name(name) + ".exr");
    }

    void save() const { write_file(chart_path(), json_dump(to_json(data_), 1) + "\n"); }

    [[nodiscard]] bool is_due(const std::vector<double>& seconds, int round) const {
        if (static_cast<int>(seconds.size()) > round) return false;
        return round == 0 || median(seconds) <= request_.once_above_s;
    }

    void trace(std::size_t t) {
        ChartTrace& to = data_.traces[t];
        const TraceResult r = trace_to_file(scene_, plan_.traces[t].settings, frame_path(to.name));
        to.records = r.records;
        to.bytes = r.bytes;
    }

    void measure_trace(std::size_t t, int round) {
        ChartTrace& to = data_.traces[t];
        if (!is_due(to.seconds, round)) return;
        to.seconds.push_back(seconds_of([&] { trace(t); }));
        save();
    }

    // Returns the path of the sample file `name`. If the file does not exist, it is traced first. This
    // happens if this run continues an earlier one, because a run deletes its sample files when it finishes.
    fs::path frame(const std::string& name) {
        fs::path path = frame_path(name);
        for (std::size_t t = 0; t < data_.traces.size(); ++t) {
            if (data_.traces[t].name == name && !fs::exists(path)) trace(t);
        }
        return path;
    }

    void references() {
        const fs::path pinhole = folder_ / "pinhole.exr";
        if (!fs::exists(pinhole))
            write_image(pinhole, pinhole_picture(SampleFileReader(frame(plan_.traces[0].name))));
        pinhole_ = read_image(pinhole);
        if (request_.reference) {
            reference_ = read_image(*request_.reference);
            if (request_.second_reference) second_ = read_image(*request_.second_reference);
            set_exposure(reference_, scene_.exposure_stops);
            if (second_) set_exposure(*second_, scene_.exposure_stops);
        } else {
            const auto halves = half_paths(folder_ / "reference.exr");
            if (!fs::exists(halves[0]) || !fs::exists(halves[1])) {
                RenderSettings s = render_settings(request_, view_);
                s.spp = 2 * request_.reference_spp;
                s.halves = true;
                s.seed = reference_seed;
                s.resume = true;
                data_.reference_s = seconds_of([&] { render_to_file(scene_, s, folder_ / "reference.exr"); });
            }
            reference_ = read_image(halves[0]);
            second_ = read_image(halves[1]);
        }
        check_size(request_.reference.value_or(folder_ / "reference.exr"),
                   {reference_.width, reference_.height});
        const Comparison c = compare(pinhole_);
        data_.affected_share = c.affected_share.value_or(0);
        data_.pinhole_psnr_db = c.whole.errors.psnr_db;
        if (c.noise) data_.noise_rms = std::sqrt(c.noise->reference_mse);
        if (!data_.record_floor) data_.record_floor = record_floor();
        write_image(folder_ / "pictures" / "reference.png", reference_);
        save();
    }

    // Returns the error of the pinhole image made from the sample file, against a ray-traced pinhole image.
    // Neither is blurred, so this error comes from the file alone: its samples at the corners of pixels only
    // approximate the mean colour of a pixel.
    [[nodiscard]] ChartError record_floor() const {
        RenderSettings s = render_settings(request_, view_);
        s.f_number = std::numeric_limits<double>::infinity();
        s.shutter.reset();
        s.spp = 2 * floor_spp;
        s.halves = true;
        s.seed = reference_seed;
        RenderResult r = render_picture(scene_, s);
        const Comparison c = compare_pictures({.image = pinhole_,
                                               .reference = std::move(r.halves[0]),
                                               .second_reference = std::move(r.halves[1])});
        return chart_error(c.whole.errors, c.noise);
    }

    [[nodiscard]] Comparison compare(const Image& image) const {
        return compare_pictures(
            {.image = image, .reference = reference_, .pinhole = pinhole_, .second_reference = second_});
    }

    void measure_point(const PlannedPoint& p, int round) {
        ChartPoint* to = nullptr;
        for (ChartPoint& q : data_.points) {
            if (q.name == p.name && q.trace == p.trace) to = &q;
        }
        if (!is_due(to->seconds, round) && to->figures) return;
        const fs::path path = p.trace.empty() ? fs::path() : frame(p.trace);
        Image image;
        std::vector<std::string> warnings;
        double retraced = 0;
        // Measures `seconds`, the time of one image: from opening the sample file until the finished image is
        // in memory. Some methods also trace rays in the scene. The scene is already in memory, so the time
        // of reading it is not included.
        const double seconds = seconds_of([&] { image = pictures_.picture(p, path, retraced, warnings); });
        if (is_due(to->seconds, round)) to->seconds.push_back(seconds);
        if (!p.trace.empty() && p.kind != PlannedPoint::Kind::motionblur && p.focus != FocusMethod::pinhole &&
            static_cast<int>(to->further_s.size()) <= round)
            measure_sweep(p, path, *to);
        if (!to->figures) {
            const std::string name = point_file_name(p.name) + ".png";
            write_image(folder_ / "pictures" / name, image);
            write_image(folder_ / "maps" / name, error_map(image, reference_));
            to->figures = chart_figures(compare(image));
            to->retraced_share = retraced;
            to->warnings = warnings;
        }
        save();
    }

    // Measures the time of the first image and of a further image that are made from one open sample file.
    // The further image takes less time, because some data are kept.
    void measure_sweep(const PlannedPoint& p, const fs::path& path, ChartPoint& to) const {
        double retraced = 0;
        std::vector<std::string> warnings;
        ThinLens stopped_down = view_.lens;
        // The f-numbers of the two images differ by 1/6 stop, because a sweep makes images with different
        // lenses.
        stopped_down.f_number *= std::exp2(1.0 / 12);
        const SampleFileReader file(path);
        FocusFrame frame(file, true);
        to.first_of_many_s.push_back(
            seconds_of([&] { (void)pictures_.focused(p, frame, stopped_down, retraced, warnings); }));
        to.further_s.push_back(
            seconds_of([&] { (void)pictures_.focused(p, frame, view_.lens, retraced, warnings); }));
    }

    const ChartRequest& request_;
    fs::path folder_;
    Scene scene_;
    ChartView view_;
    ChartPlan plan_;
    PointPictures pictures_;
    ChartData data_;
    Image pinhole_, reference_;
    std::optional<Image> second_;
    std::size_t kept_ = 0;
    bool other_machine_ = false;
};

}  // namespace

std::string point_file_name(const std::string& name) {
    std::string out;
    for (const char c : name) {
        const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           c == '.' || c == '-' || c == '_';
        if (plain) {
            out += c;
        } else if (!out.empty() && out.back() != '_') {
            out += '_';
        }
    }
    return out;
}

ChartRun run_chart(const ChartRequest& request, const fs::path& folder, bool restart) {
    check_chart_request(request);
    Runner runner(request, folder);
    ChartRun out;
    try {
        runner.run(restart, out);
    } catch (const Error& e) {
        if (e.code() != ExitCode::interrupted) throw;
        fail(ExitCode::interrupted,
             "interrupted; {} holds what is finished, and the same command goes on from it", folder.string());
    }
    return out;
}

}  // namespace postlens
