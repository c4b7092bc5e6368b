// The predicted size of a sample file, and files that do not fit on the disk.
#include "tracer/recording/expected_size.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/files/disk.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"
#include "tracer/trace.h"

namespace postlens::test::expected_size_test {
namespace {

namespace fs = std::filesystem;

std::string refusal(std::uint64_t bytes, std::uint64_t free_bytes) {
    try {
        require_disk(bytes, free_bytes, "out/frame.exr", "expected less");
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::cannot_write);
        return e.what();
    }
    return "";
}

TEST(Disk, WhatDoesNotFitIsRefusedWithBothFigures) {
    EXPECT_EQ(refusal(1000, 1000), "");
    EXPECT_EQ(refusal(0, 0), "");
    EXPECT_EQ(refusal(512'000'000, 100'000'000),
              "out/frame.exr: cannot write (needs about 512 MB, 100 MB are free; expected less)");
    EXPECT_NE(refusal(1001, 1000), "");
}

TEST(Disk, FreeBytesAreThoseOfTheTargetsFileSystem) {
    const TemporaryFolder folder;
    const std::uint64_t here = free_disk_bytes(folder.path());
    EXPECT_GT(here, 0U);
    EXPECT_LT(here, std::numeric_limits<std::uint64_t>::max());
    // The path may be a file that does not exist yet. Links are followed.
    const auto near = [&](std::uint64_t other) {
        const double ratio = static_cast<double>(other) / static_cast<double>(here);
        return ratio > 0.5 && ratio < 2;  // other processes also write to this disk
    };
    EXPECT_TRUE(near(free_disk_bytes(folder.path() / "new.exr")));
    fs::create_symlink(folder.path() / "new.exr", folder.path() / "link.exr");
    EXPECT_TRUE(near(free_disk_bytes(folder.path() / "link.exr")));
    // If the system does not report the free space, every size is accepted.
    EXPECT_EQ(free_disk_bytes("/no/such/folder/a.exr"), std::numeric_limits<std::uint64_t>::max());
}

TEST(ExpectedSize, TheLookIsAtFewRows) {
    EXPECT_EQ(looked_at_rows(1), 1);
    EXPECT_EQ(looked_at_rows(2), 2);
    EXPECT_EQ(looked_at_rows(3), 3);
    EXPECT_EQ(looked_at_rows(100), 8);
    EXPECT_LE(looked_at_rows(540), 540 * 3 / 100);
    EXPECT_LE(looked_at_rows(2160), 2160 * 3 / 100);
}

struct Case {
    const char* scene;
    int width, height;
    RecordCompression compression;
    std::optional<double> for_f_number;
};

TEST(ExpectedSize, TheFileIsAsLargeAsWasSaid) {
    const TemporaryFolder folder;
    for (const Case& c : {Case{"still_life", 160, 90, RecordCompression::zips, {}},
                          Case{"still_life", 80, 90, RecordCompression::none, {}},
                          Case{"bars", 160, 90, RecordCompression::rle, 2.8},
                          Case{"night", 320, 180, RecordCompression::zips, {}},
                          // Here a stripe of the preview belongs to two bands.
                          Case{"bars", 160, 110, RecordCompression::zips, {}},
                          Case{"ruler", 5, 3, RecordCompression::none, {}},
                          Case{"ruler", 3, 1, RecordCompression::none, {}}}) {
        const Scene scene = read_scene(std::string(POSTLENS_SAMPLES) + "/scenes/" + c.scene + ".toml");
        TraceSettings settings;
        settings.camera.width = c.width;
        settings.camera.height = c.height;
        settings.compression = c.compression;
        settings.for_f_number = c.for_f_number;
        std::uint64_t expected = 0;
        settings.on_expected_bytes = [&](std::uint64_t bytes) { expected = bytes; };
        const TraceResult r = trace_to_file(scene, settings, folder.path() / "a.exr");
        const double ratio = static_cast<double>(expected) / static_cast<double>(r.bytes);
        std::printf("%s %dx%d: %.3f of %.3f MB\n", c.scene, c.width, c.height, ratio,
                    static_cast<double>(r.bytes) / 1e6);
        if (c.height < 10) {
            // The preview pass covers all rows. The header of some kilobytes is not part of the prediction.
            EXPECT_LT(expected, r.bytes);
            EXPECT_GT(expected + 16384, r.bytes);
        } else {
            EXPECT_NEAR(ratio, 1, 0.25) << c.scene;
        }
        // Predicting the size does not change the trace.
        if (c.scene != std::string("bars")) continue;
        settings.on_expected_bytes = nullptr;
        const TraceResult unasked = trace_to_file(scene, settings, folder.path() / "b.exr");
        EXPECT_EQ(unasked.bytes, r.bytes);
        EXPECT_EQ(unasked.rays.eye, r.rays.eye);
    }
}

TEST(ExpectedSize, ATraceThatIsRefusedLeavesTheOldFile) {
    const TemporaryFolder folder;
    const fs::path target = folder.path() / "a.exr";
    std::ofstream(target) << "old";
    TraceSettings settings;
    settings.camera.width = 32;
    settings.camera.height = 24;
    settings.on_expected_bytes = [&](std::uint64_t bytes) {
        require_disk(bytes, 1000, target, "expected less");
    };
    const Scene scene = read_scene(std::string(POSTLENS_SAMPLES) + "/scenes/ruler.toml");
    try {
        (void)trace_to_file(scene, settings, target);
        FAIL() << "traced";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::cannot_write);
    }
    EXPECT_EQ(fs::file_size(target), 3U);
    EXPECT_EQ(folder.file_count(), 1U);
}

}  // namespace
}  // namespace postlens::test::expected_size_test
