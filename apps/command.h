// Options and results of the subcommands, and helpers that several subcommands use.
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

/// A warning, as `--json` lists it. `share` is the fraction of pixels that it concerns, 0 to 1, if that is
/// known.
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
    /// The image, cut to the crop, if the command writes no output file. `render --halves` adds the two
    /// halves of the samples as images.
    std::vector<Image> pictures;
    /// For `focus` and `shoot` with a scene and without an output file: the fraction of each pixel, 0 to 1,
    /// that was computed by traced rays instead of the sample file's records.
    std::vector<float> ray_share;
    ExitCode exit_code = ExitCode::ok;
};

class KeptFrame;
struct OpenFrame;

/// The option `--exposure`: a number of stops, or `auto`. Without the option, a sample file is read at its
/// own exposure and a scene at 0 stops.
struct ExposureOption {
    std::optional<double> stops;
    bool automatic = false;
};

/// A share of the work on an image: the rows or samples that one machine computes. Each share is written to
/// its own file, and `merge` joins these files (apps/share.h).
struct SharedWork {
    Share share;
    std::function<nlohmann::ordered_json()> asked_for;  ///< AskedFor::fingerprint
    std::string mark;  ///< written to the share's file (mark_of); set by take_share
};

struct TraceOptions {
    std::optional<SharedWork> shared;
    std::string scene, output;
    std::string made_by;  ///< Image::made_by of the output file; the same in the structs below
    SceneReadOptions units;
    ExposureOption exposure;
    TraceSettings settings;
    bool for_rays = false;  ///< images will be made with rays, for which TraceSettings::ray_levels suffice
    bool plan = false;      ///< choose levels, hidden layers, overscan and keys for `target_db`
    double target_db = default_target_db;
    bool force = false;  ///< trace even if the file will probably not fit on its disk
};

/// Lens options of `focus`, `records` and others. An absent value is read from the sample file.
struct LensOptions {
    std::optional<double> focal_length_mm, f_number, focus_m;
    std::optional<std::pair<double, double>> focus_at;
    Framing framing = Framing::keep;
};

/// The scene in which `hybrid` and `auto` trace rays.
struct RetraceOptions {
    std::optional<std::string> scene, explain;
    std::optional<double> metres_per_unit;  ///< absent: the sample file's
    std::optional<double> lumens_per_watt;  ///< absent: the sample file's
};

/// Throws Error(wrong_arguments) if units of a scene are given without the scene. Without a scene the units
/// would have no effect, because the records of a sample file are in metres.
void check_units(const RetraceOptions& options);

/// Options for reading an image of another program.
struct ForeignOptions {
    ForeignChoice choice;
    ForeignCameraChoice camera;
    std::vector<std::string> behind;  ///< images of the same camera that lie behind this one, nearest first
    std::string behind_layer;         ///< layer of the images in `behind`; if empty, `choice.layer`
    ObjectEffects objects;
    std::optional<ObjectChoice> matte;  ///< object that the lens blurs; if absent, the whole image is blurred
    FocusPasses passes;
    /// Names of the files that change from frame to frame: the images of `behind`, and the masks of objects.
    [[nodiscard]] std::vector<std::string*> files();
    /// True if a pixel may have several samples. They are composited even if the lens is a pinhole.
    [[nodiscard]] bool stacks() const {
        return !behind.empty() || !objects.holdouts.empty() || !objects.sharp.empty() ||
               !objects.offsets.empty() || matte || passes.any();
    }
    /// Names of the options that are given, separated by commas.
    [[nodiscard]] std::string given() const;
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
    std::optional<int> views;  ///< absent: default_lens_views, with a shutter default_shutter_views
    /// PSNR, dB, that `auto` must reach. Without it, a scene or `explain`, `auto` uses the default method.
    std::optional<double> target_db;
    RetraceOptions retrace;
    ForeignOptions foreign;
    std::optional<Crop> crop;
    ExposureOption exposure;
    bool predict = false;  ///< report the predicted error of the image
    bool strict = false;
    bool salvage = false;  ///< read the undamaged rows of a damaged sample file

    /// True for the method `auto` if there is no target PSNR, no scene and no explanation image.
    [[nodiscard]] bool takes_usual_method() const {
        return method == FocusMethod::automatic && !target_db && !retrace.scene && !retrace.explain;
    }
};

struct MergeOptions {
    std::vector<std::string> parts;
    std::string output;
    bool partial = false;
    /// Runs a command that only joins the results of its shares, the parts that several machines have
    /// computed (core/share.h).
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
    FocusOptions focus;  ///< only methods lightfield, hybrid and auto
    /// if absent, the exposure that the sample file states, beginning at the frame's instant
    std::optional<TimeSpan> shutter;
    std::string curve = "box";  ///< box, triangle or a file
    std::optional<std::string> paths;
    bool shutter_from_frame = false;  ///< `shutter` is relative to the frame's instant
};

struct RenderOptions {
    std::optional<SharedWork> shared;
    bool share_by_samples = false;  ///< true: a share computes some samples of every pixel; false: some rows
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
    /// if absent, the exposure that the sample file states, beginning at the frame's instant
    std::optional<TimeSpan> shutter;
    std::string curve = "box";  ///< box, triangle or a file
    std::optional<std::string> paths;
    /// Only for sample files: the scene. Rays into it replace samples whose colour cannot be computed from
    /// the records, for example of surfaces that were not recorded.
    RetraceOptions retrace;
    std::optional<double> target_db;  ///< with a scene: PSNR, dB, that `auto` must reach
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
    int key = 0;  ///< index of the recorded instant; 0 is the frame's own
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
    /// image of error causes to write, and the sample file that it requires
    std::optional<std::string> map_causes, frame;
    /// scene of the sample file, in which rays test whether they remove an error; `explain` is not used
    RetraceOptions retrace;
    ExposureOption exposure;  ///< absent: the reference's
    LensOptions lens;         ///< lens with which the image was made, for the map of error causes
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

/// True for an OpenEXR file from another program, that is, one that is not a sample file.
[[nodiscard]] bool is_foreign(const std::string& input);
/// Runs `focus`, `image` or `info` for an image of another program.
[[nodiscard]] CommandResult focus_foreign(const FocusOptions& options);
[[nodiscard]] CommandResult foreign_image(const ImageOptions& options);
[[nodiscard]] CommandResult foreign_info(const std::string& input);
/// Throws Error(wrong_arguments) for options that apply only to images of other programs.
void refuse_foreign_options(const ForeignOptions& options, const std::string& input);

/// Returns how the reader handles a damaged sample file: with --salvage it reads the undamaged rows.
[[nodiscard]] inline Damage damage_rule(bool salvage) {
    return salvage ? Damage::salvage : Damage::refuse;
}
/// Returns the open sample file of a command: `kept` if that is set, otherwise `input` is opened. The colours
/// are read at the given exposure.
[[nodiscard]] std::shared_ptr<OpenFrame> open_frame(const std::string& input,
                                                    const std::shared_ptr<KeptFrame>& kept,
                                                    const std::optional<double>& exposure_stops,
                                                    Damage damage);
/// Adds a warning `salvaged` with the lost rows if the file is damaged. Adds a warning `part` if the file has
/// only one machine's share of a divided trace.
void warn_of_missing_rows(const SampleFileReader& file, std::vector<Warning>& out);
/// Adds a warning `part` if an image file has only one machine's share of a divided image.
void warn_of_part(const std::string& picture, std::vector<Warning>& out);

/// Returns the value of an option, or the value in the file if the option is absent. Throws
/// Error(wrong_arguments) if both are absent. `file` is the word for the kind of file in the error message.
[[nodiscard]] double asked_or_named(const std::optional<double>& asked, const std::optional<double>& named,
                                    const char* option, const char* file);

/// Settings of the lens. Each value comes from the options, or from the sample file if the option is absent.
/// resolve_lens throws Error(wrong_arguments) if a value is in neither.
struct ResolvedLens {
    ThinLens lens;
    double focus_m = 1;
};
[[nodiscard]] ResolvedLens resolve_lens(const LensOptions& options, const SampleFileReader& file);

/// Reads a lens prescription, and adds each of its notes to `warnings`, with the code `lens`.
[[nodiscard]] Prescription read_lens(const std::filesystem::path& path, std::vector<Warning>& warnings);
/// Copies the focal length of a lens prescription to `lens`, and its f-number if `lens` has none. Throws
/// Error(wrong_arguments) if `lens` already has a focal length.
void take_from_prescription(const Impulse& impulse, LensOptions& lens, std::vector<Warning>& warnings);

/// Returns the given shutter interval, relative to the frame's instant if `from_frame` is set. If no shutter
/// is given, returns the exposure in the file. Throws Error(wrong_arguments) if both are absent.
[[nodiscard]] Exposure resolve_exposure(const std::optional<TimeSpan>& asked, const SampleHeader& header,
                                        bool from_frame = false);
/// Adds a warning if the sample file was traced for a smaller aperture or shutter interval than is now used.
void check_sufficient(const SampleHeader& header, const ThinLens& lens, std::vector<Warning>& out);
void check_sufficient(const SampleHeader& header, const Exposure& exposure, std::vector<Warning>& out);

/// Runs the method hybrid with the scene of `retrace` and adds the scene's warnings. Writes the explanation
/// image if `retrace` names one. Throws an error if the scene refers to the output file `picture`.
[[nodiscard]] HybridResult run_hybrid(FocusFrame& frame, HybridSettings settings,
                                      const RetraceOptions& retrace, const std::string& picture,
                                      CommandResult& out);
/// The numbers that `focus` and `shoot` report for an image of the method hybrid.
[[nodiscard]] nlohmann::ordered_json shares_json(const HybridResult& result);

/// Returns the shutter curve "box" or "triangle", or reads the curve from the file with this name. Throws
/// Error(invalid_input).
[[nodiscard]] ShutterCurve shutter_curve(const std::string& word);

/// The numbers of rays traced, as `--json` lists them.
[[nodiscard]] nlohmann::ordered_json rays_json(const RayCounts& rays);

/// Returns a number for JSON, or null if it is not finite, because JSON has no infinity.
[[nodiscard]] nlohmann::ordered_json json_number(double value);

}  // namespace postlens
