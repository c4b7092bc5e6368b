// Options that several subcommands have, and functions that parse option values. Only the files cli*.cpp
// include this header, because CLI11 is slow to compile.
#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli.h"
#include "apps/numbers.h"
#include "apps/options/command_words.h"
#include "focus/light_field/lens_views.h"
#include "focus/responses/depth_levels.h"
#include "pictures/exposure.h"

namespace postlens {

// These functions add an option with a numeric value. The help text of the option states the bounds of the
// value. The value is parsed by the functions of apps/numbers.h, because CLI11 does not accept "inf" and does
// not check these bounds.
CLI::Option* number(CLI::App& app, const std::string& name, std::optional<double>& to,
                    const std::string& help, const std::string& unit, const OptionRange& bounds,
                    bool infinite = false);
CLI::Option* number(CLI::App& app, const std::string& name, double& to, const std::string& help,
                    const std::string& unit, const OptionRange& bounds, bool infinite = false);
CLI::Option* whole(CLI::App& app, const std::string& name, int& to, const std::string& help,
                   const std::string& unit, const OptionRange& bounds);
CLI::Option* whole(CLI::App& app, const std::string& name, std::optional<int>& to, const std::string& help,
                   const std::string& unit, const OptionRange& bounds);
/// Adds an option that must be given. Its help text therefore states no default.
CLI::Option* required_number(CLI::App& app, const std::string& name, double& to, const std::string& help,
                             const std::string& unit, const OptionRange& bounds, bool infinite = false);
CLI::Option* required_whole(CLI::App& app, const std::string& name, int& to, const std::string& help,
                            const std::string& unit, const OptionRange& bounds);
inline constexpr OptionRange lens_view_counts{.low = 1, .high = most_lens_views},
    depth_counts{.low = 2, .high = DepthLevels::most_depths};

/// Adds an option OPEN:CLOSE for two instants in seconds. OPEN must not be after CLOSE.
CLI::Option* instants(CLI::App& app, const std::string& name, std::optional<TimeSpan>& to,
                      const std::string& help);

/// Adds the flag --dry-run. With it, the command is not run, but its time and memory are predicted. Only
/// commands whose work several machines can divide (--share) have this flag.
void dry_run_option(CLI::App& app, ParsedCommand& to);

inline constexpr OptionRange exposure_bounds{.low = -most_exposure_stops, .high = most_exposure_stops},
    lumens_bounds{.low = 1e-6, .high = 1e6};
/// Adds --exposure. Its help text states `absent` as the default.
void exposure_option(CLI::App& app, ExposureOption& to, const std::string& absent);
/// Adds the option --lumens-per-watt, which states how to convert photometric units of a scene's lights (lux,
/// candela) to radiometric ones. `when` is the beginning of its help text. It states when the option applies,
/// for example "With --scene: ".
void lumens_option(CLI::App& app, std::optional<double>& to, const std::string& when = "");

void common_options(CLI::App& app, ParsedCommand& to);
/// Throws if the command line contains one of `options` but not the option `other`, without which they have
/// no effect. Call this in a CLI11 callback, that is, when all options are parsed.
void go_with(const CLI::App& app, std::initializer_list<const char*> options, const std::string& other);
/// Adds --strict, with which a warning changes the exit code.
void strict_option(CLI::App& app, bool& to);
/// Adds --salvage to a command that reads a sample file.
void salvage_option(CLI::App& app, bool& to);
/// Adds --predict, which reports the predicted error of the image.
void predict_option(CLI::App& app, bool& to);
void output_option(CLI::App& app, std::string& to, const std::string& help);
void crop_option(CLI::App& app, std::optional<Crop>& to);
void lens_options(CLI::App& app, LensOptions& to, const std::string& source = "the file's");
/// Adds --impulse and the other options of the impulse response, i.e. the image of one scene point. If
/// `on_axis` is true, this point lies on the axis of an ideal thin lens. Then --cats-eye, which has no effect
/// on the axis, and `lens:PRESCRIPTION` (a value of --impulse), which describes a real lens, are not
/// accepted.
void impulse_options(CLI::App& app, Impulse& to, bool on_axis = false);
void scene_options(CLI::App& app, std::string& scene, SceneReadOptions& units, CameraOverrides& camera,
                   std::string& camera_name);
/// These functions add options for reading images of other programs.
void foreign_channel_options(CLI::App& app, ForeignChoice& to);
void foreign_camera_options(CLI::App& app, ForeignCameraChoice& to);
void behind_options(CLI::App& app, ForeignOptions& to);
void object_options(CLI::App& app, ForeignOptions& to);
void tree_options(CLI::App& app, int& max_depth, double& min_contribution);
void shutter_options(CLI::App& app, std::optional<TimeSpan>& shutter, std::string& curve,
                     const std::string& absent = "open for an instant");

struct LensFitLimitsOptions;
/// Adds the options for the uses of `lens fit` that need no lens prescription. They find a lens from measured
/// blur diameters (--pairs), from a range of depths that must be sharp (--sharp), or from an image made with
/// the lens (--picture). They are defined in cli_lens_fit.cpp.
std::shared_ptr<LensFitLimitsOptions> fit_limits_options(CLI::App& app);

/// Adds the subcommand `lens` with its own subcommands (cli_lens.cpp). Each subcommand has a lambda, which
/// owns the parsed options and runs the subcommand.
void add_lens_commands(CLI::App& root, ParsedCommand& common);
/// Adds the subcommand `sweep` (cli_sweep.cpp). A lambda in it owns the parsed options and runs the command.
void add_sweep(CLI::App& root, ParsedCommand& common);

template <typename Enum>
CLI::Option* choice(CLI::App& app, const std::string& name, Enum& to, const std::string& help,
                    std::vector<std::pair<std::string, Enum>> values) {
    std::string words, default_word;
    for (const auto& [word, value] : values) {
        words += (words.empty() ? "" : "|") + word;
        if (value == to) default_word = word;
    }
    return app
        .add_option_function<std::string>(
            name,
            [&to, name, words, values = std::move(values)](const std::string& text) {
                for (const auto& [word, value] : values) {
                    if (word == text) {
                        to = value;
                        return;
                    }
                }
                fail(ExitCode::wrong_arguments, "{}: unknown (got {}; expected {})", name, text, words);
            },
            fmt::format("{} [default: {}]", help, default_word))
        ->type_name(words);
}

}  // namespace postlens
