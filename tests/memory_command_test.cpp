// What a trace and a focus hold in memory grows so little with the pixels that 4K stays below 1.5 GiB.
#include <nlohmann/json.hpp>
#include <string>

#include "tests/command_test.h"

namespace postlens::test {
namespace {

using nlohmann::json;

constexpr double limit_bytes = 1.5 * 1024 * 1024 * 1024;
constexpr double px_4k = 3840.0 * 2160.0;

class MemoryOfCommand : public CommandTest {
  protected:
    struct Run {
        double px = 0, trace_bytes = 0, focus_bytes = 0, records_per_px = 0;
    };
    double peak_of(const std::vector<std::string>& words, json& said) {
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        said = r.exit_code == 0 ? json::parse(r.out) : json::object();
        return said.value("peak_memory_bytes", 0.0);
    }
    Run measured(int width, int height) {
        Run out;
        out.px = static_cast<double>(width) * height;
        const std::string frame = in("frame.exr");
        json said;
        out.trace_bytes = peak_of(
            {"trace", std::string(POSTLENS_SAMPLES) + "/scenes/still_life.toml", "-o", frame, "--size",
             std::to_string(width) + "x" + std::to_string(height), "--subdivide", "1", "--json"},
            said);
        out.records_per_px = said.value("records", 0.0) / out.px;
        out.focus_bytes = peak_of(
            {"focus", frame, "-o", in("o.exr"), "--f-number", "1.8", "--focus", "1.5", "--json"}, said);
        return out;
    }
};

// The slope between two sizes. What grows with a row's width alone counts as if it grew with the pixels, so
// the line lies above what larger frames take.
TEST_F(MemoryOfCommand, OfFourKStaysBelowOneAndAHalfGibibytes) {
    const Run small = measured(320, 180), large = measured(960, 540);
    EXPECT_GT(large.records_per_px, 3);
    const auto at_4k = [&](double small_bytes, double large_bytes) {
        EXPECT_GT(small_bytes, 1e6);
        EXPECT_GT(large_bytes, small_bytes);
        return large_bytes + (large_bytes - small_bytes) / (large.px - small.px) * (px_4k - large.px);
    };
    const double trace = at_4k(small.trace_bytes, large.trace_bytes),
                 focus = at_4k(small.focus_bytes, large.focus_bytes);
    RecordProperty("trace_mib", static_cast<int>(trace / 1048576));
    RecordProperty("focus_mib", static_cast<int>(focus / 1048576));
    EXPECT_LT(trace, limit_bytes);
    EXPECT_LT(focus, limit_bytes);
}

}  // namespace
}  // namespace postlens::test
