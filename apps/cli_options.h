// Options that several subcommands share, and the rules by which texts become values. Only cli*.cpp include
// this: CLI11 is slow to compile.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli.h"
#include "apps/named_files.h"
#include "apps/numbers.h"
#include "focus/depth_levels.h"
#include "focus/lens_views.h"
#include "records/exposure.h"

namespace postlens {

// Options whose text is parsed by our own rules (inf, ranges, messages) rather than CLI11's. The help says
// the bounds, which hold whether or not the option has an effect.
CLI::Option* number(CLI::App& app, const std::string& name, std::optional<double>& to,
                    const std::string& help, const std::string& unit, const OptionRange& bounds,
                    bool infinite = false);
CLI::Option* number(CLI::App& app, const std::string& name, double& to, const std::string& help,
                    const std::string& unit, const OptionRange& bounds, bool infinite = false);
CLI::Option* whole(CLI::App& app, const std::string& name, int& to, const std::string& help,
                   const std::string& unit, const OptionRange& bounds);
CLI::Option* whole(CLI::App& app, const std::string& name, std::optional<int>& to, const std::string& help,
                   const std::string& unit, const OptionRange& bounds);
inline constexpr OptionRange lens_view_counts{.low = 1, .high = most_lens_views},
    depth_counts{.low = 2, .high = DepthLevels::most_depths};

/// OPEN:CLOSE, OPEN not after CLOSE.
CLI::Option* instants(CLI::App& app, const std::string& name, std::optional<TimeSpan>& to,
                      const std::string& help);

/// Marks an option that names a file, as a whole or within its text (`image:FILE`, `box|triangle|FILE`), so
/// that files_of finds it: all of a command that writes files. Return the option.
CLI::Option* reads(CLI::Option* option);
CLI::Option* reads_of_impulse(CLI::Option* option);
CLI::Option* reads_of_curve(CLI::Option* option);
CLI::Option* writes(CLI::Option* option);
/// What the marked options of the subcommand that was parsed name.
[[nodiscard]] std::vector<NamedFile> files_of(CLI::App& app);

inline constexpr OptionRange exposure_bounds{.low = -most_exposure_stops, .high = most_exposure_stops},
    lumens_bounds{.low = 1e-6, .high = 1e6};
/// `absent`: what the default is.
void exposure_option(CLI::App& app, ExposureOption& to, const std::string& absent);
/// Of commands that read the scene of a sample file; `when` begins the help.
void lumens_option(CLI::App& app, std::optional<double>& to, const std::string& when = "");

void common_options(CLI::App& app, ParsedCommand& to);
/// --salvage, of everything that reads a sample file.
void salvage_option(CLI::App& app, bool& to);
/// --predict: says how far the picture is expected to be from the truth.
void predict_option(CLI::App& app, bool& to);
void output_option(CLI::App& app, std::string& to, const std::string& help);
void crop_option(CLI::App& app, std::optional<Crop>& to);
void lens_options(CLI::App& app, LensOptions& to, const std::string& source = "the file's");
/// The impulse response, for focus and render alike.
void impulse_options(CLI::App& app, Impulse& to, bool real_lenses = true);
void scene_options(CLI::App& app, std::string& scene, SceneReadOptions& units, CameraOverrides& camera,
                   std::string& camera_name);
/// Of pictures of other programs.
void foreign_channel_options(CLI::App& app, ForeignChoice& to);
void foreign_camera_options(CLI::App& app, ForeignCameraChoice& to);
void behind_options(CLI::App& app, ForeignOptions& to);
void object_options(CLI::App& app, ForeignOptions& to);
void tree_options(CLI::App& app, int& max_depth, double& min_contribution);
void shutter_options(CLI::App& app, std::optional<TimeSpan>& shutter, std::string& curve,
                     const std::string& absent = "open for an instant");

struct LensFitLimitsOptions;
/// The options of `lens fit` for thin lenses (cli_lens_fit.cpp).
std::shared_ptr<LensFitLimitsOptions> fit_limits_options(CLI::App& app);

/// `lens` and its subcommands (cli_lens.cpp); what they parse lives in the callbacks.
void add_lens_commands(CLI::App& root, ParsedCommand& common);
/// `sweep` (cli_sweep.cpp), likewise.
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
