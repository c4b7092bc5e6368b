// Helpers that the functions of the public interface share. They compose a command line, run it, and read
// values from its report. This header is not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/run_command.h"
#include "core/job.h"
#include "postlens/frame.h"
#include "postlens/job.h"
#include "postlens/lens.h"
#include "postlens/picture.h"

namespace postlens::api {

struct Job::Impl {
    explicit Impl(postlens::JobSettings settings) : job(std::move(settings)) {}
    postlens::Job job;
};

struct Frame::Impl {
    std::filesystem::path path;
    bool salvage = false;
    FrameInfo info;
    std::shared_ptr<KeptFrame> kept;  ///< null for images of other programs
};

/// Access to the private members of the public classes.
struct Internals {
    [[nodiscard]] static postlens::Job& job(Job& job) { return job.impl_->job; }
    [[nodiscard]] static const Frame::Impl& frame(const Frame& frame) { return *frame.impl_; }
};

/// Rethrows the current exception as an Error of the public interface.
[[noreturn]] void rethrow_as_error();

/// Runs `work` with the threads, progress and cancellation of `job`, and returns its result. If `job` is
/// null, uses the threads, progress and cancellation of the process. Throws only Error.
template <typename Work>
auto guarded(Job* job, const Work& work) -> decltype(work()) {
    try {
        std::optional<JobScope> scope;
        if (job != nullptr) scope.emplace(Internals::job(*job));
        throw_if_interrupted();
        return work();
    } catch (...) {
        rethrow_as_error();
    }
}

/// Composes the arguments of a command. An absent value adds no argument.
class Words {
  public:
    Words(std::initializer_list<std::string> command) : words_(command) {}
    /// Adds the path of an open file to the command line. If the file was opened with the option `--salvage`,
    /// which reads damaged files, this option is added too, because the command opens the file with the same
    /// options.
    void add(const Frame& frame);
    /// Adds a file name to the command line. Throws if the path is empty. The error message then calls the
    /// file `what`, for example "reference".
    void add_file(const char* what, const std::filesystem::path& path);

    void add(const char* option, const std::optional<double>& value);
    void add(const char* option, const std::optional<int>& value);
    /// Adds an option with an integer to the command line, or nothing if `value` is empty. The constant
    /// `automatic` (-1) is written as `auto`.
    void add_count(const char* option, const std::optional<int>& value);
    void add(const char* option, const std::optional<std::uint64_t>& value);
    void add(const char* option, const std::string& text);
    void add(const char* option, const std::filesystem::path& path) { add(option, path.string()); }
    void add(const char* option, const std::optional<Size>& size);
    void add(const char* option, const std::optional<Position>& position);
    void add(const char* option, const std::optional<Crop>& crop);
    void add(const char* option, const std::optional<Shutter>& shutter);
    void add_flag(const char* option, bool given);
    void add(const LensSettings& lens);
    /// Joins the elements of a list with commas.
    template <typename Value>
    void add_list(const char* option, const std::vector<Value>& values) {
        std::string text;
        for (const Value& value : values) text += (text.empty() ? "" : ",") + text_of(value);
        add(option, text);
    }
    /// Adds further options unchanged.
    void add(const std::vector<std::string>& options);

    [[nodiscard]] const std::vector<std::string>& words() const { return words_; }

  private:
    [[nodiscard]] static std::string text_of(double value);
    [[nodiscard]] static std::string text_of(const Shutter& shutter);
    [[nodiscard]] static const std::string& text_of(const std::string& text) { return text; }

    std::vector<std::string> words_;
};

/// Result of a command, and its report as users see it.
struct Outcome {
    CommandResult result;
    Report report;

    /// Returns a number from the JSON. Null is read as infinity, and an absent key as 0.
    [[nodiscard]] double number(const char* key) const;
    /// Returns a number from the JSON. Null is read as infinity. The result is empty if the key is absent.
    [[nodiscard]] std::optional<double> number_if_given(const char* key) const;
    /// Returns a number from the JSON. The result is empty for null and for an absent key.
    [[nodiscard]] std::optional<double> number_if_known(const char* key) const;
    [[nodiscard]] std::uint64_t count(const char* key) const;
    [[nodiscard]] std::string text(const char* key) const;
    /// Returns the picture that the command made, and removes it from `result`, so that it is not copied. If
    /// the command has written the picture to a file, `result` contains none, and an empty picture is
    /// returned.
    [[nodiscard]] Picture take_picture();
};

/// Runs a command of the program, for example `focus`, with the threads, progress and cancellation of the job
/// of this call. Throws postlens::Error, the internal type of errors.
/// - `kept`: an open file that the command uses instead of opening it again; may be null
/// - `pictures_stay`: whether pictures are returned in memory
[[nodiscard]] Outcome run_words(const Words& words, const std::shared_ptr<KeptFrame>& kept = nullptr,
                                bool pictures_stay = true);

[[nodiscard]] Picture picture_of(Image image);
/// Converts a picture to the internal type. Throws the internal Error(wrong_arguments) if the size of a
/// vector does not match the size of the picture.
[[nodiscard]] Image image_of(const Picture& picture);

}  // namespace postlens::api
