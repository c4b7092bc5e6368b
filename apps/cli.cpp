#include "apps/cli.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <span>

#include "apps/options/cli_chart.h"
#include "apps/options/command_options.h"
#include "core/text.h"

#ifndef POSTLENS_VERSION
#define POSTLENS_VERSION "unknown"
#endif

namespace postlens {
namespace {

// Throws if a flag has a value, as in --breathing=false. CLI11 would ignore this value.
void check_flags(const CLI::App& command, std::span<const std::string> words) {
    for (const std::string& word : words) {
        if (word == "--") return;
        const std::size_t equals = word.find('=');
        if (!word.starts_with("--") || equals == std::string::npos) continue;
        const std::string name = word.substr(0, equals);
        const CLI::Option* option = command.get_option_no_throw(name);
        if (option == nullptr || option->get_items_expected_max() > 0) continue;
        fail(ExitCode::wrong_arguments, "{}: takes no value (got {})", name,
             excerpt(word.substr(equals + 1)));
    }
}

// Throws an error that names the unknown option or subcommand. CLI11's error does not name it.
void check_subcommand(const CLI::App& app, std::span<const std::string> arguments) {
    const std::vector<const CLI::App*> subcommands =
        app.get_subcommands([](const CLI::App*) { return true; });
    if (subcommands.empty()) return check_flags(app, arguments);
    if (!arguments.empty() && arguments[0].starts_with('-')) {
        if (app.get_option_no_throw(arguments[0]) != nullptr) return;
        fail(ExitCode::wrong_arguments, "unknown option (got {}; expected a subcommand, see {} --help)",
             arguments[0], app.get_name());
    }
    std::string known;
    for (const CLI::App* sub : subcommands) {
        if (!arguments.empty() && sub->get_name() == arguments[0])
            return check_subcommand(*sub, arguments.subspan(1));
        known += (known.empty() ? "" : ", ") + sub->get_name();
    }
    if (arguments.empty())
        fail(ExitCode::wrong_arguments, "no subcommand (got nothing; expected one of {})", known);
    fail(ExitCode::wrong_arguments, "unknown subcommand (got {}; expected one of {})", arguments[0], known);
}

std::string full_name(const CLI::App& app) {
    const CLI::App* outer = app.get_parent();
    return outer == nullptr ? app.get_name() : full_name(*outer) + " " + app.get_name();
}

// Throws an error that names the first unknown option, and suggests the most similar known option.
void check_options(CLI::App& command) {
    for (const std::string& word : command.remaining()) {
        if (word.size() < 2 || word[0] != '-' || (word[1] != '-' && parse_number(word))) continue;
        const std::string name = word.substr(0, word.find('='));
        std::vector<std::string_view> known;
        for (const CLI::Option* option : command.get_options()) {
            for (const std::string& long_name : option->get_lnames()) known.push_back(long_name);
        }
        // For a mistyped option, suggests an option that begins with the same letters, or else one with a
        // similar name.
        const std::string asked = name.substr(word[1] == '-' ? 2 : 1);
        const auto longer = std::find_if(known.begin(), known.end(), [&](std::string_view other) {
            return asked.size() > 1 && other.starts_with(asked);
        });
        const std::string_view nearest =
            longer != known.end() ? *longer : nearest_word(asked, known, asked.size() / 2);
        fail(ExitCode::wrong_arguments, "unknown option (got {}; {}see {} --help)", name,
             nearest.empty() ? "" : fmt::format("nearest known option: --{}, ", nearest), full_name(command));
    }
}

// Reports an option or argument that has no value, or too many. CLI11's messages are hard to understand.
void check_values(const CLI::App& command, const CLI::ParseError& error) {
    const bool missing = error.get_name() == "RequiredError",
               mismatch = error.get_name() == "ArgumentMismatch";
    for (const CLI::Option* option : command.get_options()) {
        const std::string type = option->get_type_name();
        const std::string name = option->get_positional() ? type : option->get_name();
        const std::vector<std::string>& values = option->results();
        if (missing && option->get_required() && values.empty()) {
            fail(ExitCode::wrong_arguments, "{}: missing (got nothing; expected {}, see {} --help)", name,
                 option->get_positional() ? "a value" : type, full_name(command));
        }
        if (!mismatch || !std::string_view(error.what()).starts_with(option->get_name() + ":")) continue;
        if (static_cast<int>(values.size()) > option->get_items_expected_max()) {
            fail(ExitCode::wrong_arguments, "{}: stated {} times (got {}; expected one value)", name,
                 values.size(), excerpt(fmt::format("{}", fmt::join(values, " and "))));
        }
        fail(ExitCode::wrong_arguments, "{}: no value (got nothing; expected {})", name, type);
    }
}

}  // namespace

ParsedCommand parse_command_line(std::vector<std::string> arguments, const InProcess& in_process) {
    const auto state = std::make_shared<CommandOptions>();
    state->common.join = in_process.join;
    state->merge.run_words = [](std::vector<std::string> words, Join join) {
        const ParsedCommand command = parse_command_line(std::move(words), {.join = join});
        if (!command.run)
            fail(ExitCode::invalid_input, "a part's command does nothing (expected sweep or chart)");
        return command.run();
    };
    state->image.kept = state->focus.kept = state->shoot.focus.kept = state->motionblur.kept =
        in_process.kept;
    CLI::App app("postlens: render once through a pinhole, apply the lens and the shutter afterwards",
                 "postlens");
    app.set_version_flag("--version", "postlens " POSTLENS_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    add_trace(app, *state);
    add_image(app, *state);
    add_records(app, *state);
    add_render(app, *state);
    add_focus(app, *state);
    add_motionblur(app, *state);
    add_shoot(app, *state);
    add_sweep(app, state->common);
    add_lens_commands(app, state->common);
    add_compare(app, *state);
    add_chart_command(app, state->common);
    add_view(app, *state);
    add_merge(app, *state);
    add_info(app, *state);
    check_subcommand(app, arguments);
    if (in_process.pictures_stay) {
        for (const char* name : {"image", "focus", "shoot", "motionblur", "render"}) {
            app.get_subcommand(name)->get_option("--output")->required(false);
        }
    }
    std::reverse(arguments.begin(), arguments.end());  // CLI11 parses the vector from its end
    try {
        app.parse(arguments);
    } catch (const CLI::Success& e) {
        std::ostringstream text, errors;
        app.exit(e, text, errors);
        ParsedCommand help;
        help.text = text.str();
        return help;
    } catch (const CLI::ParseError& e) {
        CLI::App& command = parsed_subcommand(app);
        check_options(command);
        check_values(command, e);
        std::string what = e.what();
        std::replace(what.begin(), what.end(), '\n', ' ');
        fail(ExitCode::wrong_arguments, "{} (see {} --help)", what, full_name(command));
    }
    refuse_empty_values(app);
    refuse_shared_files(files_of(app), state->frames.frames);
    if (state->frames.frames) {
        state->frames.asked_for = [asked = asked_for(app)](int frame) {
            return asked.fingerprint([frame](const AskedFor::Input& i) {
                return i.numbered ? FrameName(i.path, i.hashes).of(frame) : i.path;
            });
        };
    }
    if (state->share) {
        state->frames.shared =
            SharedWork{*state->share, [asked = asked_for(app)] { return asked.fingerprint(); }, {}};
    }
    if (state->common.dry_run && app.get_subcommands().front()->get_name() != "sweep")
        state->common.run = [work = dry_run_of(app, *state)] { return dry_run(work); };
    ParsedCommand out = state->common;
    out.run = [state] { return state->common.run(); };
    return out;
}

}  // namespace postlens
