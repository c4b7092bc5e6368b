// What a subcommand gets and gives back.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "core/error.h"
#include "focus/focus.h"
#include "focus/focus_passes.h"
#include "focus/object_effects.h"
#include "motionblur/motion_blur.h"
#include "motionblur/vector_channels.h"
#include "planner/auto_picture.h"
#include "planner/hybrid.h"
#include "records/foreign_picture.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens {

/// A warning as `--json` lists it; `share` of the pixels concerned, where that is known.
struct Warning {
    std::string code;
    std::string text;
    double share = 0;
};

struct CommandResult {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();  ///< without seconds and warnings
    std::string text;                                                ///< for people; may have several lines
    std::vector<Warning> warnings;
    /// Where no output was named: the picture, cut to the crop; of `render --halves` also the halves.
    std::vector<Image> pictures;
    /// Of `focus` and `shoot` with a scene, likewise: per pixel the share of its view samples that are rays.
    std::vector<float> ray_share;
    ExitCode exit_code = ExitCode::ok;
};

class KeptFrame;
struct OpenFrame;

/// `--exposure`: stops, `auto`, or absent: the file's own, of a scene 0.
struct ExposureOption {
    std::optional<double> stops;
    bool automatic = false;
};

struct TraceOptions {
    std::string scene, output;
    SceneReadOptions units;
    ExposureOption exposure;
    TraceSettings settings;
    bool plan = false;  ///< levels, hidden layers, overscan and keys for `target_db`
    double target_db = default_target_db;
    bool force = false;  ///< trace even where the file will not fit on its disk
};

/// Lens options shared by `focus` and `records`; absent: what the sample file names.
struct LensOptions {
    std::optional<double> focal_length_mm, f_number, focus_m;
    std::optional<std::pair<double, double>> focus_at;
    Framing framing = Framing::keep;
};

/// The scene that `hybrid` and `auto` may look at.
struct RetraceOptions {
    std::optional<std::string> scene, explain;
    std::optional<double> metres_per_unit;  ///< absent: 1
    std::optional<double> lumens_per_watt;  ///< absent: as the sample file says
};

/// How a picture of another program is to be read.
struct ForeignOptions {
    ForeignChoice choice;
    ForeignCameraChoice camera;
    std::vector<std::string> behind;  ///< pictures of the same camera that stand behind, nearest first
    std::string behind_layer;         ///< as `choice.layer`, of those; empty: the same
    ObjectEffects objects;
    std::optional<ObjectChoice> matte;  ///< where the lens has an effect; none: everywhere
    FocusPasses passes;
    /// Names of files that belong to the picture's frame: pictures behind it, and masks of objects.
    [[nodiscard]] std::vector<std::string*> files();
    [[nodiscard]] bool given() const {
        return choice.given() || !behind.empty() || !behind_layer.empty() || !objects.holdouts.empty() ||
               !objects.sharp.empty() || !objects.offsets.empty() || matte || passes.any() ||
               camera.film_width_mm || camera.film_distance_mm || camera.depth_along ||
               camera.overscan_px != 0;
    }
};

struct FocusOptions {
    std::string input, output;
    std::shared_ptr<KeptFrame> kept;  ///< the input, where it is kept open
    LensOptions lens;
    Impulse impulse;
    FocusMethod method = FocusMethod::automatic;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    std::optional<int> depths;
    int views = default_lens_views;
    /// Of `auto`, which plans for it. Without it, a scene or `explain` it takes the usual method.
    std::optional<double> target_db;
    RetraceOptions retrace;
    ForeignOptions foreign;
    std::optional<Crop> crop;
    ExposureOption exposure;
    bool predict = false;  ///< how far it is expected to be from the truth
    bool strict = false;
    bool salvage = false;  ///< read what is whole of a damaged sample file

    /// `auto` with nothing to plan by.
    [[nodiscard]] bool takes_usual_method() const {
        return method == FocusMethod::automatic && !target_db && !retrace.scene && !retrace.explain;
    }
};

struct ImageOptions {
    std::string input, output;
    std::shared_ptr<KeptFrame> kept;  ///< as in FocusOptions
    ExposureOption exposure;
    ForeignOptions foreign;
    std::optional<Crop> crop;
    bool salvage = false;
};

struct ShootOptions {
    FocusOptions focus;               ///< methods lightfield, hybrid and auto
    std::optional<TimeSpan> shutter;  ///< absent: the file's exposure, from the frame's instant on
    std::string curve = "box";        ///< box, triangle or a file
    std::optional<std::string> paths;
    bool shutter_from_frame = false;  ///< counted from the frame's instant, not on the scene's clock
};

struct RenderOptions {
    std::string scene, output;
    SceneReadOptions units;
    ExposureOption exposure;
    LensOptions lens;
    Impulse impulse;
    std::string curve = "box";  ///< box, triangle or a file
    RenderSettings settings;
};

struct MotionBlurOptions {
    std::string input, output;
    std::shared_ptr<KeptFrame> kept;  ///< as in FocusOptions
    std::optional<TimeSpan> shutter;  ///< absent: the file's exposure, from the frame's instant on
    std::string curve = "box";        ///< box, triangle or a file
    std::optional<std::string> paths;
    VectorChoice vectors;   ///< of pictures of other programs
    ForeignChoice foreign;  ///< likewise
    MotionBlurSettings settings;
    ExposureOption exposure;
    bool shutter_from_frame = false;  ///< of sample files: as in ShootOptions
    bool predict = false;             ///< as in FocusOptions
    bool strict = false;
    bool salvage = false;
};

struct RecordsOptions {
    std::string input;
    std::pair<double, double> at;
    int key = 0;  ///< which instant: 0 the frame's own
    LensOptions lens;
    bool salvage = false;
};

struct InfoOptions {
    std::string input;
    bool salvage = false;
};

struct CompareCommandOptions {
    std::string image, reference;
    std::optional<std::string> pinhole, noise;     ///< further pictures to read
    std::optional<std::string> map, side_by_side;  ///< pictures to write
    std::optional<double> flip_white;
    CompareLimits limits;
    std::optional<std::string> map_causes, frame;  ///< a picture to write; the records that it takes
    std::optional<std::string> scene;  ///< that the records are of, to try what tracing it again shows
    double metres_per_unit = 1;
    std::optional<double> lumens_per_watt;  ///< absent: as the sample file says
    ExposureOption exposure;                ///< absent: the reference's
    LensOptions lens;                       ///< of the image, for the causes
    std::optional<TimeSpan> shutter;
    std::optional<FocusMethod> method;
    std::optional<int> depths;
};

[[nodiscard]] CommandResult run_trace(const TraceOptions& options);
[[nodiscard]] CommandResult run_render(const RenderOptions& options);
[[nodiscard]] CommandResult run_image(const ImageOptions& options);
[[nodiscard]] CommandResult run_focus(const FocusOptions& options);
[[nodiscard]] CommandResult run_shoot(const ShootOptions& options);
[[nodiscard]] CommandResult run_motionblur(const MotionBlurOptions& options);
[[nodiscard]] CommandResult run_records(const RecordsOptions& options);
[[nodiscard]] CommandResult run_compare(const CompareCommandOptions& options);
[[nodiscard]] CommandResult run_info(const InfoOptions& options);

/// An OpenEXR file that is none of ours.
[[nodiscard]] bool is_foreign(const std::string& input);
/// `focus`, `image` and `info` of such a file.
[[nodiscard]] CommandResult focus_foreign(const FocusOptions& options);
[[nodiscard]] CommandResult foreign_image(const ImageOptions& options);
[[nodiscard]] CommandResult foreign_info(const std::string& input);
/// Throws Error(wrong_arguments) where options were given that only such a file takes.
void refuse_foreign_options(const ForeignOptions& options);

/// How the reader of a sample file takes --salvage.
[[nodiscard]] inline Damage damage_rule(bool salvage) {
    return salvage ? Damage::salvage : Damage::refuse;
}
/// Opens the sample file of a command with its colours at the given exposure, or takes the one kept open.
[[nodiscard]] std::shared_ptr<OpenFrame> open_frame(const std::string& input,
                                                    const std::shared_ptr<KeptFrame>& kept,
                                                    const std::optional<double>& exposure_stops,
                                                    Damage damage);
/// A warning `salvaged` that says which rows of the file were left out; none where nothing was.
void warn_of_lost_rows(const SampleFileReader& file, std::vector<Warning>& out);

/// A value that `option` asks for, else the one that the file names. Throws Error(wrong_arguments) where
/// neither does; `file` says what kind of file it is.
[[nodiscard]] double asked_or_named(const std::optional<double>& asked, const std::optional<double>& named,
                                    const char* option, const char* file);

/// Settings of the lens for this file: what was asked for, else what the file names. Throws
/// Error(wrong_arguments) where neither says.
struct ResolvedLens {
    ThinLens lens;
    double focus_m = 1;
};
[[nodiscard]] ResolvedLens resolve_lens(const LensOptions& options, const SampleFileReader& file);

/// read_prescription, with a warning `lens` for each of its notes.
[[nodiscard]] Prescription read_lens(const std::filesystem::path& path, std::vector<Warning>& warnings);
/// A real lens has a focal length and a widest f-number of its own. Throws Error(wrong_arguments) where
/// another focal length was asked for.
void take_from_prescription(const Impulse& impulse, LensOptions& lens, std::vector<Warning>& warnings);

/// What the shutter is for this file: asked for (`from_frame`: counted from the frame's instant), else the
/// file's exposure. Throws Error(wrong_arguments).
[[nodiscard]] Exposure resolve_exposure(const std::optional<TimeSpan>& asked, const SampleHeader& header,
                                        bool from_frame = false);
/// A warning where the trace was sized for less than the lens, or the shutter, asked for.
void check_sufficient(const SampleHeader& header, const ResolvedLens& lens, std::vector<Warning>& out);
void check_sufficient(const SampleHeader& header, const Exposure& exposure, std::vector<Warning>& out);

/// Hybrid, with the scene that `retrace` names, which may not need the `picture` that is to be written;
/// writes its picture of what was done, and adds the scene's warnings.
[[nodiscard]] HybridResult run_hybrid(FocusFrame& frame, HybridSettings settings,
                                      const RetraceOptions& retrace, const std::string& picture,
                                      CommandResult& out);
/// What `focus` and `shoot` say of a picture by hybrid.
[[nodiscard]] nlohmann::ordered_json shares_json(const HybridResult& result);

/// "box", "triangle" or a file. Throws Error(invalid_input).
[[nodiscard]] ShutterCurve shutter_curve(const std::string& word);

/// The rays of a tracer, as `--json` lists them.
[[nodiscard]] nlohmann::ordered_json rays_json(const RayCounts& rays);

/// A number for JSON, which has no infinity: null.
[[nodiscard]] nlohmann::ordered_json json_number(double value);

}  // namespace postlens
