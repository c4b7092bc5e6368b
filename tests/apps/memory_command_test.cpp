// The memory of `trace` and `focus` grows so slowly with the number of pixels that 4K needs less than 1.5
// GiB.
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/command_test.h"

namespace postlens::test::memory_command_test {
namespace {

using nlohmann::json;

constexpr double limit_bytes = 1.5 * 1024 * 1024 * 1024;

class MemoryOfCommand : public CommandTest {
  protected:
    struct Run {
        double width = 0, height = 0, records = 0, trace_bytes = 0, image_bytes = 0, focus_bytes = 0;
    };
    json said_by(const std::vector<std::string>& words) {
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json::object();
    }
    Run measured(int width, int height) {
        const std::string frame = in("frame.exr"), picture = in("o.exr");
        const json traced = said_by({"trace", POSTLENS_SAMPLES "/scenes/still_life.toml", "-o", frame,
                                     "--size", std::to_string(width) + "x" + std::to_string(height),
                                     "--subdivide", "1", "--threads", "2", "--json"});
        const json image = said_by({"image", frame, "-o", picture, "--json"});
        const json focus = said_by({"focus", frame, "-o", picture, "--f-number", "8", "--focus", "1.5",
                                    "--method", "scatter", "--json"});
        constexpr const char* peak = "peak_memory_bytes";
        return {static_cast<double>(width), static_cast<double>(height), traced.value("records", 0.0),
                traced.value(peak, 0.0),    image.value(peak, 0.0),      focus.value(peak, 0.0)};
    }
};

// Memory has a constant part, a part that grows with the width (bands of rows) and one that grows with the
// number of pixels (images). Two heights and two widths determine them, with at least 3 records per pixel.
TEST_F(MemoryOfCommand, OfTracingFourKStaysBelowOneAndAHalfGibibytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer's own memory is counted with it";
#endif
    const Run low = measured(480, 60), high = measured(480, 540), wide = measured(1920, 60);
    for (const Run& r : {low, high, wide}) EXPECT_GT(r.records / (r.width * r.height), 3);
    const auto at_4k = [&](double Run::*bytes) {
        EXPECT_GT(low.*bytes, 1e6);
        const double per_px =
            (high.*bytes - low.*bytes) / (high.width * high.height - low.width * low.height);
        const double per_column = (wide.*bytes - low.*bytes) / (wide.width - low.width);
        return low.*bytes + per_column * (3840 - low.width) + per_px * 3840 * (2160 - low.height);
    };
    const double trace = at_4k(&Run::trace_bytes), image = at_4k(&Run::image_bytes);
    std::printf("at 3840x2160: trace %.0f MiB, image %.0f MiB\n", trace / 1048576, image / 1048576);
    EXPECT_LT(trace, limit_bytes);
    EXPECT_LT(image, limit_bytes);
    // The scatter method stores the records that it scatters, so its memory is measured per record.
    const double per_record = (high.focus_bytes - low.focus_bytes) / (high.records - low.records);
    std::printf("focus: %.0f bytes a record\n", per_record);
    EXPECT_LT(per_record, 256);
}

}  // namespace
}  // namespace postlens::test::memory_command_test
