// Options and results of the subcommands, and helpers that several of them share.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "core/error.h"
#include "core/share.h"
#include "focus/focus.h"
#include "focus/focus_passes.h"
#include "focus/foreign/object_effects.h"
#include "motionblur/motion_blur.h"
#include "motionblur/vectors/vector_channels.h"
#include "pictures/foreign/foreign_picture.h"
#include "planner/auto_picture.h"
#include "planner/hybrid.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens {

/// A warning, as `--json` lists it. `share` is the share of affected pixels, 0 to 1, if that is known.
struct Warning {
    std::string code;
    std::string text;
    double share = 0;
};

/// Warnings as `--json` lists them.
[[nodiscard]] inline nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const Warning& w : warnings) out.push_back({{"code", w.code}, {"share", w.share}, {"text", w.text}});
    return out;
}

struct CommandResult {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();  ///< without seconds and warnings
    std::string text;  ///< human-readable; may have several lines
    std::vector<Warning> warnings;
    /// Without an output file: the image, cut to the crop; with `render --halves` also the two halves.
    std::vector<Image> pictures;
    /// Without an output file, from `focus` and `shoot` with a scene: per pixel, the share of its view
    /// samples that rays replaced, 0 to 1.
    std::vector<float> ray_share;
    ExitCode exit_code = ExitCode::ok;
};

class KeptFrame;
struct OpenFrame;

/// `--exposure`: a number of stops or `auto`. Absent: that of the sample file, or 0 stops for a scene.
struct ExposureOption {
    std::optional<double> stops;
    bool automatic = false;
};

/// A share of an image: the rows or samples that one call computes. Every share is written to its own file;
/// `merge` joins these files (apps/share.h).
struct SharedWork {
    Share share;
    std::function<nlohmann::ordered_json()> asked_for;  ///< AskedFor::fingerprint
    std::string mark;  ///< written to the share's file (mark_of); set by take_share
};

struct TraceOptions {
    std::optional<SharedWork> shared;
    std::string scene, output;
    std::string made_by;  ///< Image::made_by of the output file; also in the structs below
    SceneReadOptions units;
    ExposureOption exposure;
    TraceSettings settings;
    bool plan = false;  ///< choose levels, hidden layers, overscan and keys for `target_db`
    double target_db = default_target_db;
    bool force = false;  ///< trace even if the file will probably not fit on its disk
};

/// Lens options of `focus`, `records` and others. An absent value is taken from the sample file.
struct LensOptions {
    std::optional<double> focal_length_mm, f_number, focus_m;
    std::optional<std::pair<double, double>> focus_at;
    Framing framing = Framing::keep;
};

/// The scene in which `hybrid` and `auto` trace rays.
struct RetraceOptions {
    std::optional<std::string> scene, explain;
    std::optional<double> metres_per_unit;  ///< absent: 1
    std::optional<double> lumens_per_watt;  ///< absent: the sample file's
};

/// Options for reading an image of another program.
struct ForeignOptions {
    ForeignChoice choice;
    ForeignCameraChoice camera;
    std::vector<std::string> behind;  ///< images of the same camera that lie behind this one, nearest first
    std::string behind_layer;         ///< layer of the images in `behind`; empty: `choice.layer`
    ObjectEffects objects;
    std::optional<ObjectChoice> matte;  ///< object that the lens blurs; none: the whole image
    FocusPasses passes;
    /// Names of files that change from frame to frame with the image: images behind it, and masks of objects.
    [[nodiscard]] std::vector<std::string*> files();
    /// Whether a pixel may hold several samples, which are composited even for a pinhole.
    [[nodiscard]] bool stacks() const {
        return !behind.empty() || !objects.holdouts.empty() || !objects.sharp.empty() ||
               !objects.offsets.empty() || matte || passes.any();
    }
    [[nodiscard]] bool given() const {
        return choice.given() || stacks() || !behind_layer.empty() || camera.film_width_mm ||
               camera.film_distance_mm || camera.depth_along || camera.overscan_px != 0;
    }
};

struct FocusOptions {
    std::optional<SharedWork> shared;
    std::string input, output, made_by;
    std::shared_ptr<KeptFrame> kept;  ///< the input if it is open already
    LensOptions lens;
    Impulse impulse;
    FocusMethod method = FocusMethod::automatic;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    std::optional<int> depths;
    int views = default_lens_views;
    /// PSNR that `auto` aims at, dB. Without this, a scene or `explain`, `auto` takes the usual method.
    std::optional<double> target_db;
    RetraceOptions retrace;
    ForeignOptions foreign;
    std::optional<Crop> crop;
    ExposureOption exposure;
    bool predict = false;  ///< report the predicted error of the image
    bool strict = false;
    bool salvage = false;  ///< read the undamaged rows of a damaged sample file

    /// True for `auto` without target, scene and explanation.
    [[nodiscard]] bool takes_usual_method() const {
        return method == FocusMethod::automatic && !target_db && !retrace.scene && !retrace.explain;
    }
};

struct MergeOptions {
    std::vector<std::string> parts;
    std::string output;
    bool partial = false;
    /// Runs a command so that it only joins what its shares have made (core/share.h).
    std::function<CommandResult(std::vector<std::string> words, Join join)> run_words;
};

struct ImageOptions {
    std::string input, output, made_by;
    std::shared_ptr<KeptFrame> kept;  ///< as in FocusOptions
    ExposureOption exposure;
    ForeignOptions foreign;
    std::optional<Crop> crop;
    bool salvage = false;
};

struct ShootOptions {
    FocusOptions focus;               ///< only methods lightfield, hybrid and auto
    std::optional<TimeSpan> shutter;  ///< absent: the file's exposure, which begins at the frame's instant
    std::string curve = "box";        ///< box, triangle or a file
    std::optional<std::string> paths;
    bool shutter_from_frame = false;  ///< `shutter` is relative to the frame's instant
};

struct RenderOptions {
    std::optional<SharedWork> shared;
    bool share_by_samples = false;  ///< true: a share is some samples of every pixel; false: some rows
    std::string scene, output, made_by;
    SceneReadOptions units;
    ExposureOption exposure;
    LensOptions lens;
    Impulse impulse;
    std::string curve = "box";  ///< box, triangle or a file
    RenderSettings settings;
};

struct MotionBlurOptions {
    std::optional<SharedWork> shared;
    std::string input, output, made_by;
    std::shared_ptr<KeptFrame> kept;  ///< as in FocusOptions
    std::optional<TimeSpan> shutter;  ///< absent: the file's exposure, which begins at the frame's instant
    std::string curve = "box";        ///< box, triangle or a file
    std::optional<std::string> paths;
    RetraceOptions retrace;           ///< for sample files: rays where the views are unsure, as with `shoot`
    std::optional<double> target_db;  ///< with a scene: PSNR that `auto` aims at, dB
    VectorChoice vectors;             ///< for images of other programs
    ForeignChoice foreign;            ///< for images of other programs
    MotionBlurSettings settings;
    ExposureOption exposure;
    bool shutter_from_frame = false;  ///< as in ShootOptions; for sample files only
    bool predict = false;             ///< as in FocusOptions
    bool strict = false;
    bool salvage = false;
};

struct RecordsOptions {
    std::string input;
    std::pair<double, double> at;
    int key = 0;  ///< index of the instant; 0 is the frame's own
    LensOptions lens;
    bool salvage = false;
};

struct InfoOptions {
    std::string input;
    bool salvage = false;
};

struct CompareCommandOptions {
    std::string image, reference;
    std::optional<std::string> pinhole, noise;     ///< further images to read
    std::optional<std::string> map, side_by_side;  ///< images to write
    std::optional<double> flip_white;
    CompareLimits limits;
    std::optional<std::string> map_causes, frame;  ///< image to write, and the sample file needed for it
    std::optional<std::string> scene;  ///< scene of the sample file, to test whether rays remove an error
    double metres_per_unit = 1;
    std::optional<double> lumens_per_watt;  ///< absent: the sample file's
    ExposureOption exposure;                ///< absent: the reference's
    LensOptions lens;                       ///< lens of the image, for the map of causes
    std::optional<TimeSpan> shutter;
    std::optional<FocusMethod> method;
    std::optional<int> depths;
};

[[nodiscard]] CommandResult run_trace(const TraceOptions& options);
[[nodiscard]] CommandResult run_render(const RenderOptions& options);
[[nodiscard]] CommandResult run_image(const ImageOptions& options);
[[nodiscard]] CommandResult run_merge(const MergeOptions& options);
[[nodiscard]] CommandResult run_focus(const FocusOptions& options);
[[nodiscard]] CommandResult run_shoot(const ShootOptions& options);
[[nodiscard]] CommandResult run_motionblur(const MotionBlurOptions& options);
[[nodiscard]] CommandResult run_records(const RecordsOptions& options);
[[nodiscard]] CommandResult run_compare(const CompareCommandOptions& options);
[[nodiscard]] CommandResult run_info(const InfoOptions& options);

/// True for an OpenEXR file that is not a sample file: an image of another program.
[[nodiscard]] bool is_foreign(const std::string& input);
/// `focus`, `image` and `info` for an image of another program.
[[nodiscard]] CommandResult focus_foreign(const FocusOptions& options);
[[nodiscard]] CommandResult foreign_image(const ImageOptions& options);
[[nodiscard]] CommandResult foreign_info(const std::string& input);
/// Throws Error(wrong_arguments) for options that apply only to images of other programs.
void refuse_foreign_options(const ForeignOptions& options);

/// Handling of damage in a sample file that --salvage selects.
[[nodiscard]] inline Damage damage_rule(bool salvage) {
    return salvage ? Damage::salvage : Damage::refuse;
}
/// The open sample file of a command. It is taken from `kept` if that is set. Its colours are read at the
/// given exposure.
[[nodiscard]] std::shared_ptr<OpenFrame> open_frame(const std::string& input,
                                                    const std::shared_ptr<KeptFrame>& kept,
                                                    const std::optional<double>& exposure_stops,
                                                    Damage damage);
/// Adds a warning `salvaged` that lists the lost rows of a damaged file, if there are any.
void warn_of_lost_rows(const SampleFileReader& file, std::vector<Warning>& out);

/// The value of `option`, else the value stored in the file. Throws Error(wrong_arguments) if both are
/// absent; `file` names the kind of file in the message.
[[nodiscard]] double asked_or_named(const std::optional<double>& asked, const std::optional<double>& named,
                                    const char* option, const char* file);

/// Settings of the lens: each value from the options, else from the sample file. resolve_lens throws
/// Error(wrong_arguments) if both lack a value.
struct ResolvedLens {
    ThinLens lens;
    double focus_m = 1;
};
[[nodiscard]] ResolvedLens resolve_lens(const LensOptions& options, const SampleFileReader& file);

/// Calls read_prescription and adds a warning `lens` for each of its notes.
[[nodiscard]] Prescription read_lens(const std::filesystem::path& path, std::vector<Warning>& warnings);
/// Sets the focal length of a lens prescription, and its f-number if `lens` has none. Throws
/// Error(wrong_arguments) if `lens` has a focal length already.
void take_from_prescription(const Impulse& impulse, LensOptions& lens, std::vector<Warning>& warnings);

/// The exposure: the given shutter (relative to the frame's instant if `from_frame`), else the file's
/// exposure. Throws Error(wrong_arguments) if both are absent.
[[nodiscard]] Exposure resolve_exposure(const std::optional<TimeSpan>& asked, const SampleHeader& header,
                                        bool from_frame = false);
/// Adds a warning if the trace was made for a smaller aperture, focus range or shutter than the given one.
void check_sufficient(const SampleHeader& header, const ResolvedLens& lens, std::vector<Warning>& out);
void check_sufficient(const SampleHeader& header, const Exposure& exposure, std::vector<Warning>& out);

/// Runs hybrid with the scene of `retrace`, adds the scene's warnings and writes the explanation image if
/// `retrace` names one. `picture` is the output file; an error is thrown if the scene refers to it.
[[nodiscard]] HybridResult run_hybrid(FocusFrame& frame, HybridSettings settings,
                                      const RetraceOptions& retrace, const std::string& picture,
                                      CommandResult& out);
/// The figures that `focus` and `shoot` report for a hybrid image.
[[nodiscard]] nlohmann::ordered_json shares_json(const HybridResult& result);

/// The shutter curve "box" or "triangle", or that of a file. Throws Error(invalid_input).
[[nodiscard]] ShutterCurve shutter_curve(const std::string& word);

/// The numbers of rays traced, as `--json` lists them.
[[nodiscard]] nlohmann::ordered_json rays_json(const RayCounts& rays);

/// A number for JSON; null if it is not finite, because JSON has no infinity.
[[nodiscard]] nlohmann::ordered_json json_number(double value);

}  // namespace postlens
