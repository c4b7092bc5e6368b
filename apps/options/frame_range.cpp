#include "apps/options/frame_range.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <new>
#include <unordered_set>

#include "apps/share.h"
#include "core/counted.h"
#include "core/job.h"
#include "core/json_dump.h"
#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr int last_frame = 9'999'999;
constexpr std::size_t most_frames = 1'000'000;

[[noreturn]] void no_range(std::string_view option, std::string_view text) {
    fail(ExitCode::wrong_arguments,
         "{}: not a range of frames (got {}; expected e.g. 1-48, 1-48x2 or 1,5,9, numbers from 0 to {})",
         option, text.empty() ? "nothing" : text, last_frame);
}

/// Parses a number at the beginning of `text` and removes it from `text`.
std::optional<int> taken_number(std::string_view& text) {
    int value = 0;
    if (text.empty() || text[0] < '0' || text[0] > '9') return std::nullopt;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || value > last_frame) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

bool taken(std::string_view& text, char c) {
    if (!text.starts_with(c)) return false;
    text.remove_prefix(1);
    return true;
}

/// Returns the length of a placeholder such as %04d at the beginning of the text, and its number of digits.
/// Returns zeros if there is none.
std::pair<std::size_t, int> place_of_number(std::string_view text) {
    if (text.starts_with("%d")) return {2, 1};
    const bool zeros = text.size() >= 4 && text[0] == '%' && text[1] == '0' && text[2] >= '1' &&
                       text[2] <= '9' && text[3] == 'd';
    return zeros ? std::pair<std::size_t, int>{4, text[2] - '0'} : std::pair<std::size_t, int>{0, 0};
}

/// Returns true if the file exists and can be read to its end.
bool is_whole(const fs::path& path) {
    std::error_code none;
    if (!fs::is_regular_file(path, none)) return false;
    try {
        if (!SampleFileReader::is_sample_file(path)) {
            const Image image = read_image(path);
            return image.width > 0;
        }
        // Checks whether the sample file is complete. Its rows are written in order, so an interrupted
        // program leaves a file without the last rows. Therefore, the file is complete if its last row can be
        // read at every instant.
        const SampleFileReader file(path);
        RecordBand band;
        for (std::size_t i = 0; i < file.instants(); ++i) file.read(file.y_end() - 1, file.y_end(), band, i);
        return file.picture().width > 0;
    } catch (const Error&) {
        return false;
    }
}

bool all_whole(const FrameFiles& files) {
    if (!is_whole(files.output) || (files.explain && !is_whole(*files.explain))) return false;
    if (!files.halves) return true;
    const auto halves = half_paths(files.output);
    return is_whole(halves[0]) && is_whole(halves[1]);
}

/// Returns `made_by`, the options and inputs of a command, as JSON text.
std::string text_of(const nlohmann::ordered_json& made_by) {
    return made_by.is_null() ? "" : json_dump(made_by);
}

/// Compares the settings that are stored in the file `output` with this command's settings, `made_by`.
/// Returns a text that names the first difference, for a message that says why the file is made again. The
/// text is empty if the settings agree. A file without settings counts as different.
std::string why_again(const fs::path& output, const nlohmann::ordered_json& made_by) {
    const std::string stated = read_made_by(output);
    const auto json = nlohmann::ordered_json::parse(stated, nullptr, false);
    if (!json.is_object()) return "its file does not say how";
    // Compares the settings in the existing output file, `json`, with those of the present run, `made_by`. In
    // the file, invalid UTF-8 (for example in a file name) was replaced when the settings were written. So
    // `text_of` makes the same replacement in `made_by`.
    return first_difference(json, nlohmann::ordered_json::parse(text_of(made_by)));
}

/// Collects the warnings of all frames. If several frames have the same warning, it is listed only once, for
/// the first of them. The text then states how many more frames have it.
class WarningsOfAll {
  public:
    void add(int frame, const std::vector<Warning>& warnings) {
        std::unordered_set<std::string> codes;
        for (const Warning& w : warnings) {
            if (!codes.insert(w.code).second) continue;
            const auto same = std::find_if(found_.begin(), found_.end(),
                                           [&](const Found& f) { return f.first.code == w.code; });
            if (same == found_.end()) {
                found_.push_back({w, frame, 1});
            } else {
                ++same->count;
            }
        }
    }
    [[nodiscard]] std::vector<Warning> list() const {
        std::vector<Warning> out;
        for (const Found& f : found_) {
            const std::string more = f.count > 1 ? fmt::format(" (and {} more)", f.count - 1) : "";
            out.push_back(
                {f.first.code, fmt::format("frame {}{}: {}", f.frame, more, f.first.text), f.first.share});
        }
        return out;
    }

  private:
    struct Found {
        Warning first;
        int frame;
        int count;
    };
    std::vector<Found> found_;
};

void check_names(const FrameFiles& names, bool in_time) {
    const auto needs_number = [](const char* what, const std::string& name) {
        if (FrameName(name, true).has_number()) return;
        fail(ExitCode::wrong_arguments,
             "--frames: {} holds no frame number (got {}; expected one, e.g. f.%04d.exr)", what, name);
    };
    needs_number("the output", names.output);
    if (names.explain) needs_number("--explain", *names.explain);
    if (!in_time) needs_number("the input is the same for every frame, as it", names.input);
    for (const std::string& pass : names.passes) {
        if (!pass.empty()) needs_number("a pass is the same for every frame, as its file", pass);
    }
}

}  // namespace

std::vector<int> parse_frames(std::string_view option, std::string_view text) {
    std::vector<int> out;
    std::unordered_set<int> seen;
    std::string_view rest = text;
    do {
        const auto first = taken_number(rest);
        if (!first) no_range(option, text);
        std::optional<int> last = first, step = 1;
        if (taken(rest, '-')) {
            last = taken_number(rest);
            if (taken(rest, 'x')) step = taken_number(rest);
        }
        if (!last || !step || *step < 1 || *last < *first) no_range(option, text);
        for (int frame = *first; frame <= *last; frame += *step) {
            if (!seen.insert(frame).second) {
                fail(ExitCode::wrong_arguments, "{}: frame {} twice (got {}; expected each once)", option,
                     frame, text);
            }
            if (out.size() == most_frames)
                fail(ExitCode::wrong_arguments, "{}: too many (got {}; expected {} or fewer)", option, text,
                     most_frames);
            out.push_back(frame);
        }
    } while (taken(rest, ','));
    if (!rest.empty()) no_range(option, text);
    return out;
}

FrameName::FrameName(std::string_view text, bool hashes) : words_(1) {
    for (std::size_t i = 0; i < text.size();) {
        const auto [length, digits] = place_of_number(text.substr(i));
        if (length == 0) {
            words_.back().push_back(text[i++]);
            continue;
        }
        digits_.push_back(digits);
        words_.emplace_back();
        i += length;
    }
    if (!digits_.empty() || !hashes) return;
    const std::size_t slash = text.rfind('/');
    const std::size_t folder = slash == std::string_view::npos ? 0 : slash + 1;
    words_.assign(1, std::string(text.substr(0, folder)));
    for (std::size_t i = folder; i < text.size();) {
        const std::size_t end = std::min(text.find_first_not_of('#', i), text.size());
        if (end == i) {
            words_.back().push_back(text[i++]);
            continue;
        }
        digits_.push_back(static_cast<int>(std::min<std::size_t>(end - i, 9)));
        words_.emplace_back();
        i = end;
    }
}

std::string FrameName::of(int frame) const {
    std::string out = words_[0];
    for (std::size_t i = 0; i < digits_.size(); ++i)
        out += fmt::format("{:0{}}{}", frame, digits_[i], words_[i + 1]);
    return out;
}

void refuse_frames(const FrameOptions& options, const FrameFiles& names) {
    if (options.keep) fail(ExitCode::wrong_arguments, "--keep: nothing to keep (expected with --frames)");
    if (options.fps) fail(ExitCode::wrong_arguments, "--fps: no frames (expected with --frames)");
    std::vector<std::string> all{names.input, names.output, names.explain.value_or("")};
    all.insert(all.end(), names.passes.begin(), names.passes.end());
    for (const std::string& name : all) {
        if (FrameName(name, false).has_number())
            fail(ExitCode::wrong_arguments, "{}: holds a frame number (expected --frames, e.g. 1-48)", name);
    }
}

CommandResult run_frame_range(
    const FrameOptions& options, const FrameFiles& names, bool in_time,
    const std::function<CommandResult(const FrameFiles&, int, const std::string&)>& run) {
    check_names(names, in_time);
    const FrameName input(names.input, !in_time), output(names.output, true),
        explain(names.explain.value_or(""), true);
    CommandResult out;
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    WarningsOfAll warnings;
    int kept = 0;
    std::size_t asked = 0;
    for (std::size_t i = 0; i < options.frames->size(); ++i) {
        const int frame = (*options.frames)[i];
        if (options.shared && !options.shared->share.has(i)) continue;
        ++asked;
        throw_if_interrupted();
        FrameFiles files{input.of(frame), output.of(frame), {}, names.halves, {}};
        if (names.explain) files.explain = explain.of(frame);
        for (const std::string& pass : names.passes) files.passes.push_back(FrameName(pass, true).of(frame));
        nlohmann::ordered_json of_frame = {{"frame", frame}, {"output", files.output}};
        const auto start = std::chrono::steady_clock::now();
        CommandResult one;
        std::string made_again;
        bool keep = false;
        try {
            nlohmann::ordered_json made_by = options.asked_for ? options.asked_for(frame) : nullptr;
            if (in_time) made_by["frame"] = frame;
            keep = options.keep && all_whole(files);
            if (keep) {
                made_again = why_again(files.output, made_by);
                if (files.halves) {
                    for (const fs::path& half : half_paths(files.output))
                        if (made_again.empty()) made_again = why_again(half, made_by);
                }
            }
            keep = keep && made_again.empty();
            if (!keep) one = run(files, frame, text_of(made_by));
        } catch (const Error& e) {
            throw Error(e.code(), fmt::format("frame {}: {}", frame, e.what()));
        } catch (const std::bad_alloc&) {
            fail(ExitCode::out_of_memory, "frame {}: not enough memory", frame);
        }
        of_frame["kept"] = keep;
        if (keep) {
            ++kept;
            frames.push_back(std::move(of_frame));
            continue;
        }
        if (!made_again.empty()) {
            of_frame["made_again"] = made_again;
            one.warnings.push_back({"made_again", "made again, as it was made otherwise: " + made_again});
        }
        of_frame.update(one.json);
        of_frame["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        of_frame["warnings"] = warnings_json(one.warnings);
        frames.push_back(std::move(of_frame));
        warnings.add(frame, one.warnings);
        if (out.exit_code == ExitCode::ok) out.exit_code = one.exit_code;
        if (!options.speak) continue;
        std::fputs(printable_lines(fmt::format("frame {}: {}\n", frame, one.text)).c_str(), stdout);
        std::fflush(stdout);  // shows progress, because a range of frames may take hours
    }
    out.warnings = warnings.list();
    out.json = {{"frames", std::move(frames)}, {"kept", kept}};
    const std::size_t made = asked - static_cast<std::size_t>(kept);
    out.text = counted(made, "frame") + " made";
    if (kept > 0) out.text += fmt::format(", {} kept", kept);
    return out;
}

}  // namespace postlens
