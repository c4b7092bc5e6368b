// If writing a file fails or is interrupted, its path holds either the unchanged old file or the complete new
// one.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <functional>
#include <random>
#include <string>
#include <sys/wait.h>
#include <thread>

#include "pictures/image.h"
#include "records/sample_file.h"
#include "tests/apps/small_disk.h"
#include "tests/support/command_test.h"

namespace postlens::test::safe_writing_test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

const std::string scenes = POSTLENS_SAMPLES "/scenes/";

class SafeWriting : public CommandTest {
  protected:
    std::string traced(const std::string& size = "64x36") {
        const Outcome r =
            run({"trace", scenes + "ruler.toml", "-o", in("frame.exr"), "--size", size, "--quiet"});
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return in("frame.exr");
    }
    /// A kind of output, and the command that writes it to a path.
    struct Output {
        std::string name;                                ///< of the file
        std::function<Words(const std::string&)> words;  ///< the command's words for a path
        bool small = false;                              ///< less than 4 kB
        bool many = false;                               ///< the path is a folder for several files
    };
    std::vector<Output> outputs(const std::string& frame) {
        const std::string plain = in("plain.exr");
        const auto image = [=](const std::string& to) { return Words{"image", frame, "-o", to}; };
        const auto focus = [=](const std::string& to) {
            return Words{"focus", frame, "-o", to, "--f-number", "2", "--focus", "2"};
        };
        const auto trace = [](const std::string& to) {
            return Words{"trace", scenes + "ruler.toml", "-o", to, "--size", "64x36"};
        };
        const auto render = [](const std::string& to) {
            return Words{"render", scenes + "ruler.toml", "-o", to, "--size", "64x36", "--spp", "1"};
        };
        const auto profile = [=](const std::string& to) {
            return Words{"lens", "psf",     plain, "--focal-length", "50", "--f-number",
                         "2",    "--focus", "1",   "--depth",        "2",  "--pixel-pitch",
                         "4",    "--size",  "999", "--profile",      to};
        };
        const auto drawing = [](const std::string& to) {
            return Words{"lens", "show", POSTLENS_SAMPLES "/lenses/double_gauss.toml", "-o", to};
        };
        const auto sweep = [=](const std::string& to) {
            return Words{"sweep", frame, "-o", to, "--f-number", "1.4:16:1", "--focus", "2"};
        };
        return {{"image.exr", image},
                {.name = "image.png", .words = image, .small = true},
                {"focus.exr", focus},
                {"frame.exr", trace},
                {"render.exr", render},
                {"profile.csv", profile},
                {.name = "drawing.svg", .words = drawing, .small = true},
                {.name = "pictures", .words = sweep, .many = true}};
    }
    static std::string line_of(const Words& words) {
        std::string line = quoted(POSTLENS_BINARY);
        for (const std::string& w : words) line += " " + quoted(w);
        return line + " --quiet";
    }
    /// Runs a shell command and returns its exit code and error output.
    Outcome shell(const std::string& line) {
        const std::string err = in(".err");
        const int status = std::system(("(" + line + ") >/dev/null 2>" + quoted(err)).c_str());
        Outcome out{WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), "", bytes_of(err)};
        fs::remove(err);
        return out;
    }
    static void expect_said(const Outcome& r, const std::string& what) {
        EXPECT_EQ(r.exit_code, 4) << what << ": " << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << what << ": " << r.err;
        EXPECT_EQ(r.err.rfind("postlens: ", 0), 0U) << what << ": " << r.err;
        EXPECT_NE(r.err.find("cannot "), std::string::npos) << what << ": " << r.err;
    }
};

TEST_F(SafeWriting, AFolderInTheWayIsFour) {
    for (const Output& output : outputs(traced())) {
        if (output.many) continue;
        fs::create_directory(in("way." + output.name));
        expect_said(run(output.words(in("way." + output.name))), output.name);
        EXPECT_TRUE(fs::is_empty(in("way." + output.name))) << output.name;
    }
}

TEST_F(SafeWriting, WithoutPermissionItIsFour) {
    const std::string frame = traced();
    ASSERT_EQ(run({"lens", "psf", in("plain.exr"), "--focal-length", "50", "--f-number", "2", "--focus", "1",
                   "--depth", "2", "--pixel-pitch", "4"})
                  .exit_code,
              0);
    const std::string nobody = as_nobody();
    if (!nobody.empty() &&
        shell(nobody + "test -x " + quoted(POSTLENS_BINARY) + " -a -r " + quoted(frame)).exit_code != 0)
        GTEST_SKIP()
            << "root may write everywhere, and cannot become somebody else who sees the program here";
    fs::permissions(folder_.path(), fs::perms::all);  // a profile is written together with its image
    fs::permissions(in("plain.exr"), fs::perms::all);
    fs::create_directory(in("locked"));
    for (const Output& output : outputs(frame)) {
        const fs::path target = folder_.path() / "locked" / output.name;
        if (!output.many) std::ofstream(target) << "old";
    }
    for (const fs::perms allowed : {fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                                        fs::perms::others_exec,  // the folder is write-protected
                                    fs::perms::all}) {           // only the files are write-protected
        for (const Output& output : outputs(frame)) {
            const fs::path target = folder_.path() / "locked" / output.name;
            const bool file_only = allowed == fs::perms::all;
            if (output.many && file_only) continue;
            if (!output.many) fs::permissions(target, fs::perms::owner_read | fs::perms::others_read);
            fs::permissions(in("locked"), allowed);
            expect_said(shell(nobody + line_of(output.words(target.string()))), output.name);
            if (output.many) continue;
            EXPECT_EQ(bytes_of(target), "old") << output.name;
        }
    }
    fs::permissions(in("locked"), fs::perms::all);
    EXPECT_EQ(static_cast<std::size_t>(std::distance(fs::directory_iterator(in("locked")), {})),
              outputs(frame).size() - 1);
}

// Uses a real full disk if this machine allows a process to mount its own file system.
TEST_F(SafeWriting, OnAFullDiskItIsFourAndTheOldFileStays) {
    const std::string frame = traced();
    fs::create_directory(in("disk"));
    if (has_small_disks(in("disk"))) {
        for (const Output& output : outputs(frame)) {
            for (const int free_kilobytes : {0, 4}) {
                // Files of less than a page fit on the disk.
                if (free_kilobytes > 0 && output.small) continue;
                const std::string target = in("disk/" + output.name);
                const std::string old_file = output.many ? "" : "echo old > " + target + "; ";
                const std::string kept =
                    output.many ? "" : "test \"$(cat " + target + ")\" = old || code=98; ";
                std::string script = fmt::format(
                    "head -c {} /dev/zero > $0/spare; {}head -c 999999 /dev/zero > $0/full 2>/dev/null; rm "
                    "$0/spare; "
                    "{}; code=$?; {}rm $0/full; test $(find $0 -type f | wc -l) = {} || code=97; exit $code",
                    1024 * free_kilobytes, old_file, line_of(output.words(target)), kept,
                    output.many ? 0 : 1);
                // The script is put between quotes, and its words need no quotes.
                std::erase(script, '\'');
                expect_said(shell(on_small_disk(in("disk"), 64, script)), output.name);
            }
        }
        return;
    }
    for (const Output& output : outputs(frame)) {
        if (output.small) continue;  // no larger than the limit
        const std::string target = in("disk/" + output.name);
        if (!output.many) std::ofstream(target) << "old";
        expect_said(shell("ulimit -f 2; " + line_of(output.words(target))), output.name);
        if (output.many) continue;
        EXPECT_EQ(bytes_of(target), "old") << output.name;
    }
    GTEST_SKIP() << "no file system of its own here: what was seen is a limit on the size of files";
}

TEST_F(SafeWriting, ATraceThatWillNotFitIsRefusedBeforeItIsMade) {
    fs::create_directory(in("disk"));
    if (!has_small_disks(in("disk"))) GTEST_SKIP() << "no file system of its own here";
    const std::string target = in("disk/frame.exr");
    const Words words{"trace", scenes + "still_life.toml", "-o", target, "--size", "160x90"};
    const auto on_disk = [&](int kilobytes, const std::string& more) {
        std::string script = "echo old > " + target + "; " + line_of(words) + more +
                             "; code=$?; test $(cat " + target +
                             ") = old && test $code = 0 && code=98; exit $code";
        std::erase(script, '\'');
        return shell(on_small_disk(in("disk"), kilobytes, script));
    };
    const Outcome refused = on_disk(512, "");
    expect_said(refused, "trace");
    EXPECT_NE(refused.err.find("needs about"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    // With --force it runs until the disk is full.
    const Outcome forced = on_disk(512, " --force");
    expect_said(forced, "trace --force");
    EXPECT_EQ(forced.err.find("needs about"), std::string::npos) << forced.err;
    EXPECT_EQ(on_disk(32768, "").exit_code, 0);
}

TEST_F(SafeWriting, AnswersThatCannotBeWrittenAreFour) {
    const std::string frame = traced();
    for (const char* command : {"info", "image"}) {
        Words words{command, frame, "--json"};
        if (words[0] == "image") words.insert(words.end(), {"-o", in("o.exr")});
        std::string line = quoted(POSTLENS_BINARY);
        for (const std::string& w : words) line += " " + quoted(w);
        const std::string err = in(".err");
        const int status = std::system((line + " >/dev/full 2>" + quoted(err)).c_str());
        expect_said({WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", bytes_of(err)}, command);
    }
    const auto code = [](const std::string& words) {
        const int status = std::system((quoted(POSTLENS_BINARY) + " " + words).c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    };
    for (const char* asks : {"--version", "--help", "focus --help"})
        EXPECT_EQ(code(std::string(asks) + " >/dev/full 2>/dev/null"), 4) << asks;
    EXPECT_EQ(code("info " + quoted(frame) + " >&- 2>/dev/null"), 4);
    // An error that cannot be said keeps its exit code, and a file is not mixed with what is said.
    for (const char* where : {"2>&-", "2>/dev/full"}) {
        EXPECT_EQ(code("info nofile " + std::string(where)), 3) << where;
        EXPECT_EQ(code("image " + quoted(frame) + " -o " + quoted(in("closed.exr")) + " >/dev/null " + where),
                  0)
            << where;
        EXPECT_EQ(bytes_of(in("closed.exr")), bytes_of(in("o.exr"))) << where;
    }
}

/// Kills a command at random instants of its run and checks the files that remain.
class Killed : public SafeWriting {
  protected:
    static constexpr int times = 20;

    /// `is_new`: whether the target is the complete new file.
    void at_any_instant(const Words& words, const std::string& target, const std::function<bool()>& is_new) {
        // Measures a run as it is started below. The first run takes longest, because its files are not
        // cached.
        Clock::duration whole_run = Clock::duration::max();
        for (int i = 0; i < 3; ++i) {
            const auto start = Clock::now();
            int status = 0;
            const pid_t child = begin(words);
            ASSERT_EQ(::waitpid(child, &status, 0), child);
            ASSERT_EQ(status, 0);
            whole_run = std::min(whole_run, Clock::now() - start);
        }
        ASSERT_TRUE(is_new());
        const std::string old_bytes = "what stood there before";
        std::mt19937 random(20);
        int killed = 0;
        // More attempts are needed if the machine was slower during the measurement.
        constexpr int at_most = 5 * times;
        for (int i = 0; i < times || (killed <= times / 4 && i < at_most); ++i) {
            std::ofstream(target, std::ios::binary | std::ios::trunc) << old_bytes;
            const std::chrono::duration<double> wait =
                std::uniform_real_distribution<double>(0.1, 1.0)(random) * whole_run;
            const pid_t child = begin(words);
            std::this_thread::sleep_for(wait);
            ::kill(child, SIGKILL);
            int status = 0;
            ASSERT_EQ(::waitpid(child, &status, 0), child);
            if (WIFSIGNALED(status)) {
                ++killed;
            } else {
                whole_run = whole_run * 9 / 10;  // the run ended before it was killed
            }
            const bool is_old = bytes_of(target) == old_bytes;
            EXPECT_TRUE(is_old || is_new()) << "instant " << i << ", after " << wait.count() << " s";
            // Only the target and hidden files with descriptive names may remain.
            for (const auto& entry : fs::directory_iterator(folder_.path())) {
                const std::string name = entry.path().filename().string();
                if (name[0] != '.') continue;
                EXPECT_NE(name.find(".part."), std::string::npos) << name;
                fs::remove(entry.path());
            }
        }
        EXPECT_GT(killed, times / 4);  // otherwise nothing was tested
        // Files that remain do not affect the next run.
        EXPECT_EQ(run(words).exit_code, 0);
        EXPECT_TRUE(is_new());
    }
};

TEST_F(Killed, TraceLeavesTheOldFileOrTheWholeNewOne) {
    const std::string target = in("frame.exr");
    std::string expected;
    at_any_instant({"trace", scenes + "ruler.toml", "-o", target, "--size", "160x90", "--quiet",
                    "--compression", "none"},
                   target, [&] {
                       if (expected.empty()) expected = bytes_of(target);
                       return bytes_of(target) == expected;
                   });
    const SampleFileReader file(target);
    RecordBand band;
    EXPECT_NO_THROW(file.read(file.y_begin(), file.y_end(), band));
}

TEST_F(Killed, FocusLeavesTheOldPictureOrTheWholeNewOne) {
    const std::string frame = traced("160x90"), target = in("picture.exr");
    std::vector<float> expected;
    at_any_instant({"focus", frame, "-o", target, "--f-number", "2", "--focus", "2", "--quiet"}, target, [&] {
        std::vector<float> now = read_image(target).rgb;
        if (expected.empty()) expected = now;
        return now == expected;
    });
}

TEST_F(Killed, RenderLeavesTheOldPictureOrTheWholeNewOne) {
    const std::string target = in("picture.exr");
    std::vector<float> expected;
    at_any_instant(
        {"render", scenes + "ruler.toml", "-o", target, "--size", "96x54", "--spp", "1", "--quiet"}, target,
        [&] {
            std::vector<float> now = read_image(target).rgb;
            if (expected.empty()) expected = now;
            return now == expected;
        });
}

}  // namespace
}  // namespace postlens::test::safe_writing_test
