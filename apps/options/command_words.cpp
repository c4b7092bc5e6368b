#include "apps/options/command_words.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "apps/options/frame_range.h"
#include "core/error.h"
#include "lens/impulse.h"
#include "pictures/stacks/object_choice.h"

namespace postlens {
namespace {

// A mark is a text attached to an option of the command line. It states what the option's value contains: for
// example, "reads" means the name of an input file, and "reads of curve" the name of a shutter curve or of
// its file.
constexpr const char *read_mark = "reads", *impulse_mark = "reads of impulse", *curve_mark = "reads of curve",
                     *object_mark = "reads of object", *write_mark = "writes";

// CLI11's options have no field for such a text. Therefore, this function adds a validator that accepts every
// value, and stores the mark as the validator's name.
CLI::Option* marked(CLI::Option* option, const char* mark) {
    return option->check([](const std::string&) { return std::string(); }, "", mark);
}

bool has_mark(CLI::Option* option, const std::string& mark) {
    try {
        return option->get_validator(mark) != nullptr;
    } catch (const CLI::OptionNotFound&) {
        return false;
    }
}

/// Returns the name of the file that the option's value `text` refers to, or an empty text if it refers to
/// none. The value may be the file name itself, such as `a.exr`, or contain it, as `image:FILE` does.
std::string path_in(CLI::Option* option, const std::string& text) {
    if (has_mark(option, read_mark) || has_mark(option, write_mark)) return text;
    if (has_mark(option, curve_mark)) return text == "box" || text == "triangle" ? "" : text;
    if (has_mark(option, object_mark)) {
        const bool offset = option->get_name() == "--focus-offset";
        const std::string object = offset ? text.substr(0, text.rfind('=')) : text;
        return ObjectChoice{option->get_name(), object}.is_file() ? object : "";
    }
    return has_mark(option, impulse_mark) ? file_of_impulse(text) : "";
}

}  // namespace

CLI::Option* reads(CLI::Option* option) {
    return marked(option, read_mark);
}

CLI::Option* reads_of_impulse(CLI::Option* option) {
    return marked(option, impulse_mark);
}

CLI::Option* reads_of_curve(CLI::Option* option) {
    return marked(option, curve_mark);
}

CLI::Option* reads_of_object(CLI::Option* option) {
    return marked(option, object_mark);
}

CLI::Option* writes(CLI::Option* option) {
    return marked(option, write_mark);
}

CLI::App& parsed_subcommand(CLI::App& app) {
    const std::vector<CLI::App*> inner = app.get_subcommands();
    return inner.empty() ? app : parsed_subcommand(*inner.front());
}

std::vector<NamedFile> files_of(CLI::App& app) {
    std::vector<NamedFile> out;
    for (CLI::Option* option :
         parsed_subcommand(app).get_options([](CLI::Option* o) { return o->count() > 0; })) {
        const bool positional = option->get_positional(), written = has_mark(option, write_mark);
        for (const std::string& text : option->results()) {
            const std::string path = path_in(option, text);
            if (path.empty()) continue;
            out.push_back({.option = positional ? option->get_type_name() : option->get_name(),
                           .path = path,
                           .written = written,
                           .numbered = positional || written,
                           // `hashes` is true if # stands for a digit of the frame number in this file name.
                           // This is so for all files except a scene.
                           .hashes = option->get_name() != "scene"});
        }
    }
    return out;
}

void refuse_empty_values(CLI::App& app) {
    for (CLI::App* inner : app.get_subcommands()) refuse_empty_values(*inner);
    for (CLI::Option* option : app.get_options([](CLI::Option* o) { return o->count() > 0; })) {
        const std::vector<std::string>& texts = option->results();
        if (std::find(texts.begin(), texts.end(), "") == texts.end()) continue;
        const std::string type = option->get_type_name();
        fail(ExitCode::wrong_arguments, "{}: no value (got an empty text; expected {})",
             option->get_positional() ? type : option->get_name(), type);
    }
}

AskedFor asked_for(CLI::App& root) {
    CLI::App& app = parsed_subcommand(root);
    AskedFor out;
    out.command = app.get_name();
    // Options that do not change the result, but only where and how fast it is computed, and which messages
    // are printed.
    std::vector<std::string> left_out{"--share",   "--threads", "--quiet",        "--json",
                                      "--resume",  "--keep",    "--requeue-code", "--dry-run",
                                      "--restart", "--strict",  "--force"};
    if (app.get_option_no_throw("--keep") != nullptr)
        left_out.emplace_back("--frames");  // a range, not a name
    for (CLI::Option* option : app.get_options([](CLI::Option* o) { return o->count() > 0; })) {
        const std::string name = option->get_positional() ? option->get_type_name() : option->get_name();
        if (has_mark(option, write_mark) ||
            std::find(left_out.begin(), left_out.end(), name) != left_out.end())
            continue;
        const bool scene = name == "SCENE" || name == "--scene";
        // With --frames, only positional arguments and these options accept a placeholder for the frame
        // number in the file name.
        const std::set<std::string> passes{"--depth-file", "--ids-file",   "--vectors-file", "--behind",
                                           "--holdout",    "--keep-sharp", "--focus-offset", "--matte"};
        const bool numbered = option->get_positional() || passes.contains(name);
        for (const std::string& text : option->results()) {
            const std::string path = path_in(option, text);
            const std::size_t at = text.find(path);
            std::error_code none;
            if (!path.empty() &&
                (std::filesystem::exists(path, none) || (numbered && FrameName(path, !scene).has_number()))) {
                out.inputs.push_back({.option = name,
                                      .before = text.substr(0, at),
                                      .after = text.substr(at + path.size()),
                                      .path = path,
                                      .numbered = numbered,
                                      .hashes = !scene,
                                      .scene = scene});
            } else if (out.options.empty() || out.options.back().first != name) {
                out.options.push_back({name, {text}});
            } else {
                out.options.back().second.push_back(text);
            }
        }
    }
    std::sort(out.options.begin(), out.options.end());
    return out;
}

std::vector<std::string> words_of(CLI::App& app) {
    std::vector<std::string> out, options;
    if (app.get_parent() != nullptr) out.push_back(app.get_name());
    for (CLI::App* inner : app.get_subcommands()) {
        const std::vector<std::string> words = words_of(*inner);
        out.insert(out.end(), words.begin(), words.end());
    }
    for (CLI::Option* option : app.get_options([](CLI::Option* o) { return o->count() > 0; })) {
        const std::vector<std::string> left_out{"--share", "--dry-run", "--json", "--restart"};
        if (has_mark(option, write_mark) ||
            std::find(left_out.begin(), left_out.end(), option->get_name()) != left_out.end())
            continue;
        const bool flag = option->get_expected_max() == 0;
        for (const std::string& text : option->results()) {
            // Appends the option to the command line. An option with a value is written as one word,
            // --name=value. If the value were a separate word and began with a dash, it would be parsed as
            // another option.
            if (option->get_positional())
                out.push_back(text);
            else
                options.push_back(flag ? option->get_name() : option->get_name() + "=" + text);
        }
    }
    out.insert(out.end(), options.begin(), options.end());
    return out;
}

}  // namespace postlens
