#include "apps/commands/dry_run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "apps/numbers.h"
#include "core/child_process.h"
#include "core/counted.h"
#include "core/files/scratch_file.h"
#include "core/files/share_table.h"
#include "core/files/text_file.h"
#include "pictures/image.h"
#include "tracer/distributed/render_state.h"
#include "tracer/render.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Cost {
    double seconds = 0;
    std::uint64_t memory_bytes = 0;
};

/// The predicted time of a command in seconds: a fixed time plus a time for each sample or view.
struct Line {
    double fixed_s = 0, each_s = 0;
    int measured = 1;  ///< largest number of samples or views that was measured
    std::uint64_t memory_bytes = 0;
    [[nodiscard]] Cost at(double amount) const { return {fixed_s + each_s * amount, memory_bytes}; }
};

/// Returns the indices of at most `most` of `count` items, evenly spaced, including the first and the last.
std::vector<int> spread(int count, int most) {
    std::vector<int> out;
    const int n = std::min(count, most);
    out.reserve(static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k)
        out.push_back(n == 1 ? 0 : static_cast<int>(static_cast<std::int64_t>(count - 1) * k / (n - 1)));
    return out;
}

/// Returns the estimated cost (time and memory) of item i, for example of a frame. It is estimated from the
/// nearest items before and after i whose cost was measured.
Cost between(const std::map<int, Cost>& measured, int i) {
    const auto above = measured.lower_bound(i);
    if (above == measured.end()) return measured.rbegin()->second;
    if (above->first == i || above == measured.begin()) return above->second;
    const auto below = std::prev(above);
    // The time is interpolated linearly between the two items, and the memory is the larger of theirs.
    const double t = static_cast<double>(i - below->first) / (above->first - below->first);
    return {below->second.seconds + t * (above->second.seconds - below->second.seconds),
            std::max(below->second.memory_bytes, above->second.memory_bytes)};
}

class Measured {
  public:
    explicit Measured(const DryRun& work) : work_(work), folder_("output") {
        fs::create_directories(folder_.path());
    }

    /// Throws errors that can be found without running the command, for example if the output folder is
    /// missing.
    void check() const {
        const fs::path folder = fs::absolute(work_.output).parent_path();
        if (std::error_code none; !fs::is_directory(folder, none))
            fail(ExitCode::cannot_write, "{}: cannot be written (no such folder)", work_.output);
        if (work_.frames && work_.output_of(0) == work_.output_of(1)) {
            fail(ExitCode::wrong_arguments,
                 "--frames: the output holds no frame number (got {}; expected one, e.g. f.%04d.exr)",
                 work_.output);
        }
        if (work_.by_samples && !work_.frames)
            static_cast<void>(
                sample_blocks(work_.shares, work_.amount, halves()));  // refuses too many shares
    }

    [[nodiscard]] Json tasks() {
        const std::vector<Cost> costs = costs_of_tasks();
        Json out = Json::array();
        for (int i = 0; i < work_.shares; ++i) {
            const Cost& c = costs[static_cast<std::size_t>(i)];
            out.push_back({{"share", fmt::format("{}/{}", i, work_.shares)},
                           {"outputs", outputs_of(i)},
                           {"memory_bytes", c.memory_bytes},
                           {"seconds", c.seconds}});
        }
        return out;
    }

    [[nodiscard]] Json merge() const {
        if (work_.shares == 1 || work_.frames) return nullptr;
        Json words{"merge"};
        for (int i = 0; i < work_.shares; ++i) words.push_back(outputs_of(i)[0]);
        words.insert(words.end(), {"-o", work_.output});
        return words;
    }

  private:
    [[nodiscard]] bool halves() const {
        return std::find(work_.words.begin(), work_.words.end(), "--halves") != work_.words.end();
    }

    [[nodiscard]] std::vector<Cost> costs_of_tasks() {
        if (work_.frames) return of_frames();
        if (work_.pictures > 0) return of_pictures();
        if (work_.shares > 1 && work_.amount_option.empty()) return of_rows({});
        const Line whole = line({});
        if (work_.shares == 1) return {whole.at(work_.amount)};
        return work_.by_samples ? of_samples(whole) : of_rows(whole);
    }

    /// Runs the command whose cost is predicted (`work_`) once in its own process, and returns the time and
    /// memory that it needed.
    /// - `more`: options that are added to the command line
    /// - `amount`: number of samples or views for this run, instead of the user's number
    /// - `ending`: extension of the output file
    [[nodiscard]] Cost run(const std::vector<std::string>& more, int amount, const std::string& ending) {
        std::vector<std::string> words{fs::read_symlink("/proc/self/exe").string()};
        for (const std::string& word : work_.words) {
            // The words do not contain --share, without which --share-by is refused.
            const bool replaced =
                (!work_.amount_option.empty() && word.starts_with(work_.amount_option + "=")) ||
                (work_.frames && word.starts_with("--frames=")) || word.starts_with("--share-by=");
            if (!replaced && word != "--resume" && word != "--keep") words.push_back(word);
        }
        words.insert(words.end(), more.begin(), more.end());
        if (!work_.amount_option.empty()) words.push_back(fmt::format("{}={}", work_.amount_option, amount));
        output_ = folder_.path() / ((work_.frames ? "%04d" : "picture") + ending);
        if (work_.pictures > 0) output_ = folder_.path() / "sweep";
        words.insert(words.end(), {"--output", output_.string()});
        const fs::path log = folder_.path() / "log";
        const ChildResult child = run_child(words, log);
        if (child.exit_code != 0 && child.exit_code != static_cast<int>(ExitCode::shortfall))
            refuse(child, log);
        return {child.seconds, child.peak_memory_bytes};
    }
    [[nodiscard]] Cost run(const std::vector<std::string>& more, int amount) {
        return run(more, amount, fs::path(work_.output).extension().string());
    }

    /// Throws the error that a child process has reported.
    [[noreturn]] static void refuse(const ChildResult& child, const fs::path& log) {
        constexpr std::uintmax_t longest = 1'000'000;
        const std::string said = read_text_file(log, longest);
        constexpr std::string_view begin = "postlens: ";
        std::size_t at = said.rfind("\npostlens: ");
        at = at == std::string::npos ? 0 : at + 1;
        std::string line = said.substr(at, said.find('\n', at) - at);
        if (line.starts_with(begin)) line.erase(0, begin.size());
        throw Error(static_cast<ExitCode>(child.exit_code),
                    line.empty() ? "--dry-run: a part of the command was ended" : line);
    }

    /// Predicts the command's run time as a linear function of its number of samples or views: a fixed time
    /// plus a time for each. The function is found from two short runs, the second with twice as many samples
    /// or views as the first. Their numbers are doubled until the two times clearly differ.
    [[nodiscard]] Line line(const std::vector<std::string>& more) {
        constexpr int first_part = 16;
        constexpr double clear_s = 0.15;
        // Number of samples or views for the first of several timing runs: one sixteenth (1 / first_part) of
        // those of the full command. It is an even number, because --halves divides samples into two equal
        // halves.
        int amount = std::min(work_.amount, std::max(2, work_.amount / first_part / 2 * 2));
        Cost a = run(more, amount);
        if (work_.amount_option.empty()) return {a.seconds, 0, 1, a.memory_bytes};
        for (;;) {
            if (amount >= work_.amount) return {a.seconds, 0, amount, a.memory_bytes};
            const int twice = std::min(2 * amount, work_.amount);
            const Cost b = run(more, twice);
            const double more_s = b.seconds - a.seconds;
            const std::uint64_t memory = std::max(a.memory_bytes, b.memory_bytes);
            if (twice == work_.amount) return {b.seconds, 0, twice, memory};
            if (more_s > clear_s) {
                const double each = more_s / (twice - amount);
                return {std::max(0.0, b.seconds - each * twice), each, twice, memory};
            }
            a = b;
            amount = twice;
        }
    }

    [[nodiscard]] std::vector<Cost> of_frames() {
        const std::vector<int>& frames = *work_.frames;
        const auto frame = [&](int i) {
            return std::vector<std::string>{fmt::format("--frames={}", frames[static_cast<std::size_t>(i)])};
        };
        constexpr int most_measured = 3;
        const std::vector<int> some = spread(static_cast<int>(frames.size()), most_measured);
        const int middle = some[some.size() / 2];
        const Line of_middle = line(frame(middle));
        std::map<int, Cost> measured{{middle, of_middle.at(work_.amount)}};
        for (const int i : some) {
            if (measured.contains(i)) continue;
            const Cost c = run(frame(i), of_middle.measured);
            // Predicts the full time of frame i from a short run with only a few of its samples or views. For
            // the frame in the middle of the sequence, both times are known. The full times of the two frames
            // are assumed to have the same ratio as their short times, `scale`.
            const double scale = c.seconds / of_middle.at(of_middle.measured).seconds;
            measured[i] = {scale * of_middle.at(work_.amount).seconds, c.memory_bytes};
        }
        std::vector<Cost> out(static_cast<std::size_t>(work_.shares));
        for (std::size_t i = 0; i < frames.size(); ++i) {
            Cost& task = out[i % out.size()];
            const Cost c = between(measured, static_cast<int>(i));
            task.seconds += c.seconds;
            task.memory_bytes = std::max(task.memory_bytes, c.memory_bytes);
        }
        return out;
    }

    /// Predicts the cost (time and memory) for machines that divide the images of the command `sweep`. The
    /// time of a machine is a fixed time, for example for reading the sample file, plus a time for each of
    /// its images.
    [[nodiscard]] std::vector<Cost> of_pictures() {
        const int n = work_.pictures, middle = n / 2;
        const auto share = [](int i, int count) {
            return std::vector<std::string>{fmt::format("--share={}/{}", i, count)};
        };
        const Cost one = run(share(middle, n), 0);
        constexpr std::uintmax_t largest_bytes = 64'000'000;
        const Json table = Json::parse(
            read_text_file(output_ / share_table_name("sweep", {middle, n}), largest_bytes), nullptr, false);
        const double fixed =
            std::max(0.0, one.seconds - table.at("pictures").at(0).at("seconds").get<double>());
        constexpr int most_measured = 4;
        const int step = n / std::min(n, most_measured);
        double sum_s = 0;
        int runs = 0, pictures_run = 0;
        std::uint64_t memory = one.memory_bytes;
        for (const int first : std::set<int>{0, step - 1}) {
            const Cost some = run(share(first, step), 0);
            sum_s += some.seconds;
            ++runs;
            pictures_run += (n - first + step - 1) / step;
            memory = std::max(memory, some.memory_bytes);
        }
        const double each = std::max(0.0, sum_s - runs * fixed) / pictures_run;
        std::vector<Cost> out;
        out.reserve(static_cast<std::size_t>(work_.shares));
        for (int i = 0; i < work_.shares; ++i) {
            const int pictures = (n - i + work_.shares - 1) / work_.shares;
            out.push_back({fixed + each * pictures, memory});
        }
        return out;
    }

    [[nodiscard]] std::vector<Cost> of_samples(const Line& whole) {
        // Returns the predicted cost (time and memory) for each of `shares` machines, of which each computes
        // some of the samples of every pixel.
        const ImageSize size = read_image_size(output_);
        const int blocks =
            (sample_blocks(work_.shares, work_.amount, halves()) + work_.shares - 1) / work_.shares;
        const auto bytes = [&](int b) {
            return RenderState::bytes(size.width, size.height, halves() ? 2 : 1, b);
        };
        Cost each = whole.at(static_cast<double>(work_.amount) / work_.shares);
        // A machine stores the radiance of each pixel as several sums, each over a block of samples. The
        // measured runs stored only one block. Therefore, the memory of the further blocks is added.
        each.memory_bytes += bytes(blocks) - bytes(1);
        return std::vector<Cost>(static_cast<std::size_t>(work_.shares), each);
    }

    [[nodiscard]] std::vector<Cost> of_rows(const Line& whole) {
        constexpr int most_measured = 6;
        // Measures the cost (time and memory) for machines that each compute a group of the image's rows. The
        // earlier timing runs, `whole`, computed all rows. A run for one machine computes only 1/shares of
        // the rows, so it can use `shares` times as many samples or views in about the same time.
        const int amount = static_cast<int>(
            std::min<std::int64_t>(work_.amount, std::int64_t{whole.measured} * work_.shares));
        std::map<int, Cost> measured;
        for (const int i : spread(work_.shares, most_measured)) {
            Cost c = run({fmt::format("--share={}/{}", i, work_.shares)}, amount, ".exr");
            if (!work_.amount_option.empty() && amount < work_.amount) {
                const double each = std::max(0.0, c.seconds - whole.fixed_s) / amount;
                c.seconds += each * (work_.amount - amount);
            }
            measured[i] = c;
        }
        std::vector<Cost> out;
        out.reserve(static_cast<std::size_t>(work_.shares));
        for (int i = 0; i < work_.shares; ++i) out.push_back(between(measured, i));
        return out;
    }

    [[nodiscard]] Json outputs_of(int i) const {
        if (work_.frames) {
            Json out = Json::array();
            for (std::size_t k = 0; k < work_.frames->size(); ++k) {
                if (Share{i, work_.shares}.has(k)) out.push_back(work_.output_of((*work_.frames)[k]));
            }
            return out;
        }
        const fs::path output(work_.output);
        if (work_.pictures > 0) {
            const std::string table =
                work_.shares == 1 ? "sweep.json" : share_table_name("sweep", {i, work_.shares});
            return {(output / table).string()};
        }
        if (work_.shares == 1) return {work_.output};
        fs::path part = output;
        part.replace_extension(fmt::format("part{}.exr", i));
        return {part.string()};
    }

    const DryRun& work_;
    ScratchFile folder_;
    fs::path output_;  ///< output of the last run
};

}  // namespace

CommandResult dry_run(const DryRun& work) {
    Measured measured(work);
    measured.check();
    CommandResult out;
    out.json = {{"tasks", measured.tasks()}, {"merge", measured.merge()}};
    double longest = 0, sum = 0;
    std::uint64_t memory = 0;
    for (const Json& task : out.json["tasks"]) {
        longest = std::max(longest, task["seconds"].get<double>());
        sum += task["seconds"].get<double>();
        memory = std::max(memory, task["memory_bytes"].get<std::uint64_t>());
    }
    out.json["longest_seconds"] = longest;
    out.json["all_seconds"] = sum;
    out.json["most_memory_bytes"] = memory;
    out.text = fmt::format("{} of up to {:.3g} s and {:.3g} MB, {:.3g} s in all",
                           counted(work.shares, "task"), longest, static_cast<double>(memory) / 1e6, sum);
    return out;
}

}  // namespace postlens
