// For each command, the options that change from frame to frame.
#include <cmath>
#include <functional>

#include "apps/exposure.h"
#include "apps/numbers.h"
#include "apps/options/frame_range.h"
#include "apps/share.h"
#include "motionblur/vectors/vector_frame.h"
#include "pictures/foreign/foreign_file.h"
#include "tracer/exposure.h"

namespace postlens {
namespace {

constexpr double default_fps = 24;

/// Returns the instant of a frame on the scene's clock, in seconds: frame / fps plus --time.
double time_of(const FrameOptions& options, int frame, const std::optional<double>& time_s) {
    return frame / options.fps.value_or(default_fps) + time_s.value_or(0);
}

void check_fps(const FrameOptions& options) {
    if (options.fps) in_range("--fps", *options.fps, 0, false, "more than 0");
}

std::optional<TimeSpan> moved(std::optional<TimeSpan> span, double by_s) {
    if (span) span = TimeSpan{span->open_s + by_s, span->close_s + by_s};
    return span;
}

/// Returns the raster size of a sample file, or of an image of another program.
ImageSize raster_of(const std::string& input, bool salvage, int overscan_px) {
    if (salvage || !is_foreign(input)) {
        const SampleFileReader file(input, damage_rule(salvage));
        return {file.header().width, file.header().height};
    }
    const Window display = ForeignFile(input).parts()[0].display;
    return {display.x_max - display.x_min + 1 - 2 * overscan_px,
            display.y_max - display.y_min + 1 - 2 * overscan_px};
}

/// If several machines divide the rows of one image (--share), sets `crop` to the rows that this machine
/// makes. Also sets `shared`, a description of these rows, by which `merge` later joins the files of the
/// machines.
void divide(const FrameOptions& frames, const std::string& output, std::optional<SharedWork>& shared,
            std::optional<Crop>& crop, const std::function<ImageSize()>& raster) {
    // With --frames, the machines divide the frames and not the rows.
    if (!frames.shared || frames.frames) return;
    check_exr_path(output, "parts");
    shared = frames.shared;
    const ImageSize size = raster();
    take_share(shared, crop, size.width, size.height);
}

bool decides_by_errors(const FocusOptions& o) {
    return o.method == FocusMethod::automatic && !o.takes_usual_method();
}

void refuse_shared_target(const FrameOptions& frames, bool decides, const RetraceOptions& retrace) {
    if (!frames.shared || frames.frames) return;
    if (decides) {
        fail(ExitCode::wrong_arguments,
             "--share: not with --method auto and a target or a scene, which look at the whole picture "
             "(expected another method, or --frames)");
    }
    if (retrace.explain) fail(ExitCode::wrong_arguments, "--share: not with --explain");
}

/// Replaces the exposure `auto` by that of the first frame, so that a sequence does not flicker.
ExposureOption of_first_frame(const ExposureOption& asked, const std::function<double()>& stops) {
    if (!asked.automatic) return asked;
    return {.stops = stops()};
}

/// Returns the name of the first frame's input file. It is `name`, in which a placeholder such as %04d is
/// replaced by the number of this frame. If `hashes` is true, the placeholder may also be a sequence of #,
/// one for each digit.
std::string first_input(const FrameOptions& frames, const std::string& name, bool hashes) {
    return FrameName(name, hashes).of(frames.frames->front());
}

template <typename Options>
ExposureOption exposure_of_first_scene(const FrameOptions& frames, const Options& o) {
    if (!frames.frames) return o.exposure;
    return of_first_frame(o.exposure, [&] {
        const Scene scene = read_scene(first_input(frames, o.scene, false), o.units);
        return auto_exposure_stops(scene, o.settings.camera_name, o.settings.camera);
    });
}

ExposureOption exposure_of_first_file(const FrameOptions& frames, const ExposureOption& asked,
                                      const std::string& input, bool salvage,
                                      const std::function<Image(const std::string&)>& foreign) {
    if (!frames.frames) return asked;
    return of_first_frame(asked, [&] {
        const std::string first = first_input(frames, input, true);
        if (!salvage && is_foreign(first)) return auto_exposure_of(foreign(first));
        return *exposure_of_samples(asked, first, damage_rule(salvage));
    });
}

/// Returns the names of the separate files with the depths, ids and motion vectors of an image. A name may be
/// empty.
std::vector<std::string> passes_of(const ForeignChoice& choice, const VectorChoice& vectors = {}) {
    return {choice.depth_file.string(), choice.ids_file.string(), vectors.file.string()};
}

void set_passes(ForeignChoice& choice, const FrameFiles& files) {
    choice.depth_file = files.passes[0];
    choice.ids_file = files.passes[1];
}

/// Returns the options with the file names of the first frame.
ForeignChoice of_first(const FrameOptions& frames, ForeignChoice choice) {
    if (!frames.frames) return choice;
    for (std::filesystem::path* file : {&choice.depth_file, &choice.ids_file})
        *file = first_input(frames, file->string(), true);
    return choice;
}

/// Returns the part of a command's options that contains `exposure` and `made_by` (the text stored in the
/// image about how it was made). For most commands, these are members of `options` itself. But ShootOptions
/// contains them in its member `focus`.
template <typename Options>
auto& image_of(Options& options) {
    if constexpr (requires { options.focus; }) {
        return options.focus;
    } else {
        return options;
    }
}

/// Runs a command once for each frame of --frames, or once without --frames. Before each run, `adapt` sets
/// the file names and times of the frame.
template <typename Options, typename Adapt>
CommandResult each_frame(const FrameOptions& frames, const FrameFiles& names, const Options& options,
                         CommandResult (*run)(const Options&), const Adapt& adapt) {
    if (!frames.frames) {
        refuse_frames(frames, names);
        return run(options);
    }
    constexpr bool has_time = requires(Options o) {
        o.settings.time_s;
    };
    if (has_time) check_fps(frames);
    FrameOptions range = frames;
    if (frames.asked_for) {
        range.asked_for = [&](int frame) {
            nlohmann::ordered_json out = frames.asked_for(frame);
            // With --exposure auto, all frames get the exposure of the first frame. If this exposure has
            // changed since an earlier run, the frames of that run must not be kept. Therefore, the exposure
            // is added to `out`, the settings by which a run recognises frames that it can keep.
            if (const auto& stops = image_of(options).exposure.stops) out["exposure_stops"] = *stops;
            return out;
        };
    }
    return run_frame_range(range, names, has_time,
                           [&](const FrameFiles& files, int frame, const std::string& made_by) {
                               Options o = options;
                               image_of(o).made_by = made_by;
                               if constexpr (has_time)
                                   o.settings.time_s = time_of(frames, frame, options.settings.time_s);
                               adapt(o, files);
                               CommandResult out = run(o);
                               if constexpr (has_time) out.json["time_s"] = *o.settings.time_s;
                               return out;
                           });
}

}  // namespace

CommandResult run_frames(const FrameOptions& frames, const TraceOptions& asked) {
    TraceOptions options = asked;
    if (frames.shared && !frames.frames) options.shared = frames.shared;
    options.exposure = exposure_of_first_scene(frames, asked);
    return each_frame(frames, {options.scene, options.output, {}, false, {}}, options, run_trace,
                      [](TraceOptions& o, const FrameFiles& files) {
                          o.scene = files.input;
                          o.output = files.output;
                          o.settings.for_shutter = moved(o.settings.for_shutter, *o.settings.time_s);
                      });
}

CommandResult run_frames(const FrameOptions& frames, const RenderOptions& asked) {
    RenderOptions options = asked;
    if (frames.shared && !frames.frames) {
        check_exr_path(options.output, "parts");
        options.shared = frames.shared;  // run_render divides the work after it has read the scene
    }
    options.exposure = exposure_of_first_scene(frames, asked);
    return each_frame(frames, {options.scene, options.output, {}, options.settings.halves, {}}, options,
                      run_render, [](RenderOptions& o, const FrameFiles& files) {
                          o.scene = files.input;
                          o.output = files.output;
                          o.settings.shutter = moved(o.settings.shutter, *o.settings.time_s);
                      });
}

CommandResult run_frames(const FrameOptions& frames, const ImageOptions& asked) {
    ImageOptions options = asked;
    options.exposure = exposure_of_first_file(
        frames, asked.exposure, asked.input, asked.salvage, [&](const std::string& first) {
            return read_foreign_picture(first, of_first(frames, asked.foreign.choice), asked.foreign.camera)
                .flattened();
        });
    return each_frame(frames, {options.input, options.output, {}, false, passes_of(asked.foreign.choice)},
                      options, run_image, [](ImageOptions& o, const FrameFiles& files) {
                          set_passes(o.foreign.choice, files);
                          o.input = files.input;
                          o.output = files.output;
                      });
}

CommandResult run_frames(const FrameOptions& frames, const FocusOptions& asked) {
    FocusOptions options = asked;
    refuse_shared_target(frames, decides_by_errors(asked), asked.retrace);
    divide(frames, options.output, options.shared, options.crop,
           [&] { return raster_of(asked.input, asked.salvage, asked.foreign.camera.overscan_px); });
    options.exposure = exposure_of_first_file(
        frames, asked.exposure, asked.input, asked.salvage, [&](const std::string& first) {
            return read_foreign_picture(first, of_first(frames, asked.foreign.choice), asked.foreign.camera)
                .flattened();
        });
    std::vector<std::string> passes = passes_of(asked.foreign.choice);
    const std::size_t own = passes.size();
    for (const std::string* file : options.foreign.files()) passes.push_back(*file);
    return each_frame(frames,
                      {options.input, options.output, options.retrace.explain, false, std::move(passes)},
                      options, run_focus, [own](FocusOptions& o, const FrameFiles& files) {
                          set_passes(o.foreign.choice, files);
                          std::size_t next = own;
                          for (std::string* file : o.foreign.files()) *file = files.passes[next++];
                          o.input = files.input;
                          o.output = files.output;
                          o.retrace.explain = files.explain;
                      });
}

CommandResult run_frames(const FrameOptions& frames, const MotionBlurOptions& asked) {
    MotionBlurOptions options = asked;
    refuse_shared_target(frames, asked.retrace.scene && asked.settings.method == MotionMethod::automatic,
                         asked.retrace);
    divide(frames, options.output, options.shared, options.settings.crop,
           [&] { return raster_of(asked.input, asked.salvage, 0); });
    options.exposure = exposure_of_first_file(
        frames, asked.exposure, asked.input, asked.salvage, [&](const std::string& first) {
            VectorChoice vectors = asked.vectors;
            vectors.file = first_input(frames, vectors.file.string(), true);
            return read_vector_frame(first, vectors, of_first(frames, asked.foreign)).picture();
        });
    return each_frame(frames,
                      {options.input, options.output, options.retrace.explain, false,
                       passes_of(asked.foreign, asked.vectors)},
                      options, run_motionblur, [](MotionBlurOptions& o, const FrameFiles& files) {
                          set_passes(o.foreign, files);
                          o.vectors.file = files.passes[2];
                          o.retrace.explain = files.explain;
                          o.input = files.input;
                          o.output = files.output;
                          o.shutter_from_frame = true;
                      });
}

CommandResult run_frames(const FrameOptions& frames, const ShootOptions& asked) {
    ShootOptions options = asked;
    FocusOptions& focus = options.focus;
    refuse_shared_target(frames, decides_by_errors(focus), focus.retrace);
    divide(frames, focus.output, focus.shared, focus.crop,
           [&] { return raster_of(asked.focus.input, asked.focus.salvage, 0); });
    if (frames.frames && focus.exposure.automatic) {
        const std::string first = first_input(frames, focus.input, true);
        focus.exposure = {.stops = exposure_of_samples(focus.exposure, first, damage_rule(focus.salvage))};
    }
    return each_frame(frames, {focus.input, focus.output, focus.retrace.explain, false, {}}, options,
                      run_shoot, [](ShootOptions& o, const FrameFiles& files) {
                          o.focus.input = files.input;
                          o.focus.output = files.output;
                          o.focus.retrace.explain = files.explain;
                          o.shutter_from_frame = true;
                      });
}

}  // namespace postlens
