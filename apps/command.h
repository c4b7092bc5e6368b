// Options and results of the subcommands, and functions that several subcommands use.
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

/// A warning of a command. `share` is the fraction of the pixels affected (0 to 1), or 0 if it is not known.
struct Warning {
    std::string code;
    std::string text;
    double share = 0;
};

/// Returns warnings as `--json` lists them.
[[nodiscard]] inline nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const Warning& w : warnings) out.push_back({{"code", w.code}, {"share", w.share}, {"text", w.text}});
    return out;
}

struct CommandResult {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();  ///< without seconds and warnings
    std::string text;  ///< human-readable; may have several lines
    std::vector<Warning> warnings;
    /// The image that the command made. It is empty if the image was written to a file. With `render
    /// --halves`, two more images follow, each of which was made from half of the samples. Their difference
    /// shows the noise.
    std::vector<Image> pictures;
    /// Fraction of each pixel's colour that comes from traced rays, from 0 to 1. Set only by `focus` and
    /// `shoot` if they trace rays.
    std::vector<float> ray_share;
    ExitCode exit_code = ExitCode::ok;
    /// Work that begins after the command has printed its result: `view` runs its web server until it is
    /// cancelled.
    std::function<void()> afterwards;
};

class KeptFrame;
struct OpenFrame;

/// The option `--exposure`: a number of stops, or `auto`. Without the option, the command chooses the
/// exposure.
struct ExposureOption {
    std::optional<double> stops;
    bool automatic = false;
};

/// One share of the work on an image, computed by one of several machines. `merge` joins the files of all
/// shares.
struct SharedWork {
    Share share;
    std::function<nlohmann::ordered_json()> asked_for;  ///< AskedFor::fingerprint
    std::string mark;  ///< written to the file of the share (mark_of); set by take_share
};

struct TraceOptions {
    std::optional<SharedWork> shared;
    std::string scene, output;
    std::string made_by;  ///< Image::made_by of the output file; the same in the structs below
    SceneReadOptions units;
    ExposureOption exposure;
    TraceSettings settings;
    bool for_rays = false;  ///< images will be made with rays, so fewer records are needed
    bool plan = false;      ///< choose levels, hidden layers, overscan and keys for `target_db`
    double target_db = default_target_db;
    bool force = false;  ///< trace even if the file will probably not fit on its disk
};

/// Lens options of several commands, such as `focus` and `records`. An absent value is read from the sample
/// file.
struct LensOptions {
    std::optional<double> focal_length_mm, f_number, focus_m;
    std::optional<std::pair<double, double>> focus_at;
    Framing framing = Framing::keep;
};

/// Options for tracing additional rays into the scene from which a sample file was made. `explain` is the
/// path of an output image. It shows which pixels are computed from the sample file and which from rays.
struct RetraceOptions {
    std::optional<std::string> scene, explain;
    std::optional<double> metres_per_unit;  ///< if absent, the sample file's value
    std::optional<double> lumens_per_watt;  ///< if absent, the sample file's value
};

/// Throws Error(wrong_arguments) if `metres_per_unit` or `lumens_per_watt` is given but `scene` is not. These
/// two describe the units of the scene's file, so they have no effect without it.
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
    /// Returns pointers to the names of the files with background images and object masks. With --frames, a
    /// name may contain a placeholder for the frame number, such as %04d. Through the pointers, the caller
    /// replaces the placeholder by the number of the frame.
    [[nodiscard]] std::vector<std::string*> files();
    /// Returns true if a pixel may have to be composited from several samples at different depths.
    [[nodiscard]] bool stacks() const {
        return !behind.empty() || !objects.holdouts.empty() || !objects.sharp.empty() ||
               !objects.offsets.empty() || matte || passes.any();
    }
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
    std::optional<int> views;  ///< if absent, default_lens_views, or default_shutter_views with a shutter
    /// PSNR, in dB, that the method `auto` tries to reach (by default, 40 dB).
    std::optional<double> target_db;
    RetraceOptions retrace;
    ForeignOptions foreign;
    std::optional<Crop> crop;
    ExposureOption exposure;
    bool predict = false;  ///< report the predicted error of the image
    bool strict = false;
    bool salvage = false;  ///< read the undamaged rows of a damaged sample file

    /// True if the method is `auto` without a target PSNR, a scene or --explain. `auto` then only chooses
    /// between the methods `layers` and `scatter`.
    [[nodiscard]] bool takes_usual_method() const {
        return method == FocusMethod::automatic && !target_db && !retrace.scene && !retrace.explain;
    }
};

struct MergeOptions {
    std::vector<std::string> parts;
    std::string output;
    bool partial = false;
    /// Runs the command line `words`, by which several machines made the result files in `parts`, once more.
    /// With `join`, this run computes nothing. It only joins the results of the machines.
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
    /// Times, in seconds, at which the shutter opens and closes. If they are not given, the shutter opens at
    /// the instant of the frame, and stays open for the exposure time that is stored in the sample file.
    std::optional<TimeSpan> shutter;
    std::string curve = "box";  ///< box, triangle or a file
    std::optional<std::string> paths;
    bool shutter_from_frame = false;  ///< `shutter` is relative to the frame's instant
};

struct RenderOptions {
    std::optional<SharedWork> shared;
    /// How several machines divide the image. If true, each machine computes some samples of every pixel. If
    /// false, each machine computes all samples of some rows.
    bool share_by_samples = false;
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
    /// Times, in seconds, at which the shutter opens and closes. If they are not given, the shutter opens at
    /// the instant of the frame, and stays open for the exposure time that is stored in the sample file.
    std::optional<TimeSpan> shutter;
    std::string curve = "box";  ///< box, triangle or a file
    std::optional<std::string> paths;
    /// The scene from which the sample file was traced. If it is given, additional rays compute colours that
    /// the sample file lacks, for example those of hidden surfaces.
    RetraceOptions retrace;
    std::optional<double> target_db;  ///< with a scene: PSNR in dB that `auto` tries to reach
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
    int key = 0;  ///< index of the recorded instant; 0 means the instant of the frame
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
    std::optional<Crop> crop;                      ///< part of the images that is compared
    std::optional<double> flip_white;
    CompareLimits limits;
    /// `map_causes` names an output image that shows the cause of each pixel's error. `frame` names the
    /// sample file from which the tested image was made, which is needed for this.
    std::optional<std::string> map_causes, frame;
    /// The scene from which the sample file `frame` was traced. If its file is named here, rays are traced in
    /// the scene, because they help to find the causes of errors in the image that `compare` tests.
    RetraceOptions retrace;
    ExposureOption exposure;  ///< if absent, the exposure of the reference
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

/// Returns true for an OpenEXR file of another program, that is, one that is not a sample file.
[[nodiscard]] bool is_foreign(const std::string& input);
/// These functions run `focus`, `image` and `info` for an image of another program.
[[nodiscard]] CommandResult focus_foreign(const FocusOptions& options);
[[nodiscard]] CommandResult foreign_image(const ImageOptions& options);
[[nodiscard]] CommandResult foreign_info(const std::string& input);
/// Throws Error(wrong_arguments) if `options` has options that apply only to images of other programs.
void refuse_foreign_options(const ForeignOptions& options, const std::string& input);

/// Returns how to read a damaged sample file. With --salvage, its undamaged rows are read. Otherwise, damage
/// is an error.
[[nodiscard]] inline Damage damage_rule(bool salvage) {
    return salvage ? Damage::salvage : Damage::refuse;
}
/// Opens the sample file `input` and returns it. Colours are read at the given exposure, in stops. An earlier
/// command may have opened the file already and kept it in memory, in `kept`. If `kept` is not null, it is
/// used instead of opening the file again.
[[nodiscard]] std::shared_ptr<OpenFrame> open_frame(const std::string& input,
                                                    const std::shared_ptr<KeptFrame>& kept,
                                                    const std::optional<double>& exposure_stops,
                                                    Damage damage);
/// Adds the warning `salvaged` if rows of the sample file are damaged.
/// Adds the warning `part` if the file contains only one machine's share of the rows.
void warn_of_missing_rows(const SampleFileReader& file, std::vector<Warning>& out);
/// Adds the warning `part` if an image file contains only one machine's share of the image.
void warn_of_part(const std::string& picture, std::vector<Warning>& out);

/// Returns `asked`, the value that the user's option states. If the option is absent, returns `named`, the
/// value that the input file states. Throws Error(wrong_arguments) if both are absent. `file` is the kind of
/// file for the error message, for example "sample file".
[[nodiscard]] double asked_or_named(const std::optional<double>& asked, const std::optional<double>& named,
                                    const char* option, const char* file);

/// A lens and its focus distance. resolve_lens takes each value from the options, or else from the sample
/// file. It throws Error(wrong_arguments) if neither states the value.
struct ResolvedLens {
    ThinLens lens;
    double focus_m = 1;
};
[[nodiscard]] ResolvedLens resolve_lens(const LensOptions& options, const SampleFileReader& file);

/// Reads a lens prescription. Each note of the reader becomes a warning with the code `lens`.
[[nodiscard]] Prescription read_lens(const std::filesystem::path& path, std::vector<Warning>& warnings);
/// Copies the focal length of the lens prescription to `lens`, and the f-number if `lens` has none. Throws
/// Error(wrong_arguments) if the user has also given a focal length.
void take_from_prescription(const Impulse& impulse, LensOptions& lens, std::vector<Warning>& warnings);

/// Returns the interval in which the shutter is open: `asked` if it is given, otherwise the interval stored
/// in the sample file. With `from_frame`, the times in `asked` count from the instant of the frame instead of
/// 0. Throws Error(wrong_arguments) if neither `asked` nor the file states an interval.
[[nodiscard]] Exposure resolve_exposure(const std::optional<TimeSpan>& asked, const SampleHeader& header,
                                        bool from_frame = false);
/// Warns if the aperture or the exposure interval is larger than those for which the sample file was traced.
void check_sufficient(const SampleHeader& header, const ThinLens& lens, std::vector<Warning>& out);
void check_sufficient(const SampleHeader& header, const Exposure& exposure, std::vector<Warning>& out);

/// Makes an image by the method hybrid: reprojects the samples of the sample file to many lens points, and
/// averages the resulting views. If `retrace` names a scene, rays into this scene supply what the file does
/// not contain. `picture` is the path of the output image. Throws if the scene refers to this file, because
/// it would be overwritten.
[[nodiscard]] HybridResult run_hybrid(FocusFrame& frame, HybridSettings settings,
                                      const RetraceOptions& retrace, const std::string& picture,
                                      CommandResult& out);
/// Returns the JSON with which the commands `focus` and `shoot` describe an image of the method hybrid. Such
/// an image is made from the sample file's records and from additional rays. The JSON contains, for example,
/// the number of these rays.
[[nodiscard]] nlohmann::ordered_json shares_json(const HybridResult& result);

/// Returns the shutter curve "box" or "triangle", or else reads the file of this name. Throws
/// Error(invalid_input) if the file cannot be read.
[[nodiscard]] ShutterCurve shutter_curve(const std::string& word);

/// Returns the numbers of traced rays, as `--json` lists them.
[[nodiscard]] nlohmann::ordered_json rays_json(const RayCounts& rays);

/// Returns a number for JSON, or null if it is not finite, because JSON has no infinity.
[[nodiscard]] nlohmann::ordered_json json_number(double value);

}  // namespace postlens
