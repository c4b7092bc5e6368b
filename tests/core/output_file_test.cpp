// Output files are complete or absent.
#include "core/files/output_file.h"

#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "core/error.h"
#include "tests/core/error_text.h"
#include "tests/core/folder_test.h"

namespace postlens::test::output_file_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class OutputFileTest : public FolderTest {};

TEST_F(OutputFileTest, IsAbsentUntilCommittedAndWholeAfterwards) {
    OutputFile file(folder_ / "picture.exr");
    EXPECT_EQ(file.target(), folder_ / "picture.exr");
    EXPECT_EQ(file.temporary_path().parent_path(), folder_);
    EXPECT_EQ(file.temporary_path().extension(), ".exr");
    write_bytes(file.temporary_path(), "whole");
    EXPECT_FALSE(fs::exists(file.target()));
    file.commit();
    EXPECT_EQ(bytes_of(file.target()), "whole");
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, WithoutCommitTheOlderTargetStaysAndNoTemporary) {
    const fs::path target = folder_ / "picture.exr";
    write_bytes(target, "older");
    EXPECT_THROW(
        {
            OutputFile file(target);
            write_bytes(file.temporary_path(), "half");
            throw std::runtime_error("the writer failed");
        },
        std::runtime_error);
    EXPECT_EQ(bytes_of(target), "older");
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, CommitReplacesTheTarget) {
    const fs::path target = folder_ / "picture.exr";
    write_bytes(target, "a longer, older text");
    {
        OutputFile file(target);
        write_bytes(file.temporary_path(), "newer");
        EXPECT_EQ(bytes_of(target), "a longer, older text");
        file.commit();
    }
    EXPECT_EQ(bytes_of(target), "newer");
}

TEST_F(OutputFileTest, TwoFilesOfOneNameDoNotShareATemporary) {
    // Two runs in different containers may have the same process id and write the same picture.exr.
    OutputFile first(folder_ / "picture.exr");
    OutputFile second(folder_ / "picture.exr");
    EXPECT_NE(first.temporary_path(), second.temporary_path());
    write_bytes(first.temporary_path(), "first");
    write_bytes(second.temporary_path(), "second");
    first.commit();
    EXPECT_EQ(bytes_of(folder_ / "picture.exr"), "first");
    second.commit();
    EXPECT_EQ(bytes_of(folder_ / "picture.exr"), "second");
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, KeepsASymbolicLinkAndReplacesWhatItLeadsTo) {
    fs::create_directory(folder_ / "disk");
    write_bytes(folder_ / "disk" / "real.exr", "older");
    fs::create_symlink(folder_ / "disk" / "real.exr", folder_ / "link.exr");
    OutputFile file(folder_ / "link.exr");
    EXPECT_EQ(file.temporary_path().parent_path(), fs::canonical(folder_ / "disk"));
    write_bytes(file.temporary_path(), "newer");
    file.commit();
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.exr"));
    EXPECT_EQ(bytes_of(folder_ / "disk" / "real.exr"), "newer");
}

TEST_F(OutputFileTest, KeepsASymbolicLinkToAFileThatDoesNotExistYet) {
    fs::create_directory(folder_ / "disk");
    fs::create_symlink("disk/first.exr", folder_ / "first.exr");
    fs::create_symlink("first.exr", folder_ / "second.exr");
    OutputFile file(folder_ / "second.exr");
    write_bytes(file.temporary_path(), "new");
    file.commit();
    EXPECT_TRUE(fs::is_symlink(folder_ / "first.exr"));
    EXPECT_TRUE(fs::is_symlink(folder_ / "second.exr"));
    EXPECT_EQ(bytes_of(folder_ / "disk" / "first.exr"), "new");
    fs::create_symlink("loop.exr", folder_ / "loop.exr");
    EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { OutputFile loop(folder_ / "loop.exr"); }),
                HasSubstr("symbolic links"));
    fs::create_symlink("missing/x.exr", folder_ / "nowhere.exr");
    EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { OutputFile nowhere(folder_ / "nowhere.exr"); }),
                HasSubstr("does not exist"));
}

TEST_F(OutputFileTest, NewFilesHaveThePermissionsThatTheUserMaskLeaves) {
    const mode_t old_mask = ::umask(027);
    OutputFile file(folder_ / "picture.exr");
    ::umask(old_mask);
    file.commit();
    EXPECT_EQ(static_cast<unsigned>(fs::status(file.target()).permissions()), 0640U);
}

TEST_F(OutputFileTest, TakesANameAsLongAsAFileSystemAllows) {
    const std::string name = std::string(251, 'n') + ".exr";
    OutputFile file(folder_ / name);
    file.commit();
    EXPECT_THAT(names_in(folder_), ElementsAre(name));
}

TEST_F(OutputFileTest, TakesANameWithoutAFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    {
        OutputFile file("picture.png");
        write_bytes(file.temporary_path(), "here");
        file.commit();
    }
    fs::current_path(before);
    EXPECT_EQ(bytes_of(folder_ / "picture.png"), "here");
}

TEST_F(OutputFileTest, RefusesAFolder) {
    for (const fs::path& target : {folder_, folder_ / ""}) {
        EXPECT_EQ(error_text(ExitCode::cannot_write, [&] { OutputFile file(target); }),
                  target.string() + ": cannot write (got a folder; expected a file name)");
    }
    EXPECT_THAT(names_in(folder_), IsEmpty());
}

TEST_F(OutputFileTest, RefusesAMissingFolder) {
    const fs::path target = folder_ / "missing" / "picture.exr";
    EXPECT_EQ(
        error_text(ExitCode::cannot_write, [&] { OutputFile file(target); }),
        target.string() + ": cannot write (folder " + (folder_ / "missing").string() + " does not exist)");
}

TEST_F(OutputFileTest, RefusesADeviceInsteadOfReplacingIt) {
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0666), 0);
    EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { OutputFile file(pipe); }), HasSubstr("device"));
    EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { OutputFile file("/dev/null"); }),
                HasSubstr("device"));
    EXPECT_TRUE(fs::is_fifo(pipe));
}

/// Root ignores file permissions, so a child process that tests them changes to another user first.
void give_up_root() {
    constexpr uid_t nobody = 65534;
    if (::geteuid() != 0) return;
    if (::setgid(nobody) != 0 || ::setuid(nobody) != 0) throw std::runtime_error("cannot give up root");
}

TEST_F(OutputFileTest, RefusesAFolderThatMayNotBeWritten) {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                                 fs::perms::others_exec);
    const fs::path target = folder_ / "picture.exr";
    const int status = status_of_child([&] {
        give_up_root();
        const std::string text = error_text(ExitCode::cannot_write, [&] { OutputFile file(target); });
        ::_exit(text == target.string() + ": cannot write (Permission denied)" ? 7 : 8);
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
    fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(OutputFileTest, RefusesAFileThatItsOwnerProtected) {
    const fs::path target = folder_ / "picture.exr";
    write_bytes(target, "older");
    fs::permissions(folder_, fs::perms::all);
    fs::permissions(target, fs::perms::owner_read | fs::perms::others_read);
    const int status = status_of_child([&] {
        give_up_root();
        const std::string text = error_text(ExitCode::cannot_write, [&] { OutputFile file(target); });
        ::_exit(text == target.string() + ": cannot write (Permission denied)" ? 7 : 8);
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
}

TEST_F(OutputFileTest, CommitSaysWhenTheTemporaryIsGone) {
    const fs::path target = folder_ / "picture.exr";
    write_bytes(target, "older");
    OutputFile file(target);
    fs::remove(file.temporary_path());
    EXPECT_EQ(error_text(ExitCode::cannot_write, [&] { file.commit(); }),
              target.string() + ": cannot write (No such file or directory)");
    EXPECT_EQ(bytes_of(target), "older");
}

TEST_F(OutputFileTest, CommitSaysWhenTheTargetBecameAFolder) {
    const fs::path target = folder_ / "picture.exr";
    {
        OutputFile file(target);
        fs::create_directory(target);
        EXPECT_THAT(error_text(ExitCode::cannot_write, [&] { file.commit(); }),
                    StartsWith(target.string() + ": cannot write ("));
    }
    EXPECT_THAT(names_in(folder_), ElementsAre("picture.exr"));
    EXPECT_THAT(names_in(target), IsEmpty());
}

TEST_F(OutputFileTest, MoreFilesThanAreListedForSignalsAreWrittenAllTheSame) {
    constexpr int count = 100;
    {
        std::vector<std::unique_ptr<OutputFile>> files;
        files.reserve(count);
        for (int i = 0; i < count; ++i) {
            files.push_back(std::make_unique<OutputFile>(folder_ / fmt::format("f.{:04}.exr", i)));
        }
        for (int i = 0; i < count; i += 2) files[static_cast<std::size_t>(i)]->commit();
    }
    EXPECT_EQ(names_in(folder_).size(), count / 2U);
}

}  // namespace
}  // namespace postlens::test::output_file_test
