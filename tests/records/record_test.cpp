#include "records/record.h"

#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "records/record_check.h"

namespace postlens::test::record_test {
namespace {

using Bounce = NodePath::Bounce;

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(NodePath, TextNamesTheChainFromTheEyeOn) {
    EXPECT_EQ(NodePath().text(), "primary");
    const NodePath path =
        NodePath().child(Bounce::reflected).child(Bounce::transmitted).child(Bounce::transmitted);
    EXPECT_EQ(path.text(), "RTT");
    EXPECT_EQ(path.depth(), 3);
    EXPECT_EQ(path.kind(), Bounce::transmitted);
    EXPECT_EQ(path.parent().text(), "RT");
    EXPECT_EQ(path.bits(), 0b101001U);
}

TEST(NodePath, ReservedValuesAndGapsAreInvalid) {
    EXPECT_TRUE(NodePath(0b1001).valid());
    EXPECT_FALSE(NodePath(0b1100).valid());
    EXPECT_FALSE(NodePath(0b0111).valid());
    EXPECT_FALSE(NodePath(0b0100).valid());
    NodePath longest;
    for (int i = 0; i < NodePath::max_bounces; ++i) longest = longest.child(Bounce::transmitted);
    EXPECT_TRUE(longest.valid());
    EXPECT_EQ(longest.depth(), NodePath::max_bounces);
}

Record record_at(float x, float y) {
    Record r;
    r.x = x;
    r.y = y;
    r.z = 2;
    return r;
}

struct BadPixel {
    const char* part_of_message;
    std::function<void(std::vector<Record>&)> damage;
};

TEST(RecordCheck, NamesWhatIsWrong) {
    const RecordChannels all{true, true};
    const std::vector<Record> good{record_at(-3, 7), record_at(-2.5F, 7.5F)};
    ASSERT_EQ(problem_of_pixel(good, -3, 7, all), nullptr);
    const std::vector<BadPixel> cases{
        {"upper-left corner", [](auto& r) { r.clear(); }},
        {"upper-left corner", [](auto& r) { r.erase(r.begin()); }},
        {"upper-left corner", [](auto& r) { r[0].layer = r[1].layer = 1; }},
        {"1/1024", [](auto& r) { r[1].x = -2; }},
        {"1/1024", [](auto& r) { r[1].x = -3.5F; }},
        {"1/1024", [](auto& r) { r[1].x += 1.0F / 2048; }},
        {"1/1024", [](auto& r) { r[1].y = nan; }},
        {"z'", [](auto& r) { r[0].z = 0; }},
        {"z'", [](auto& r) { r[0].z = -inf; }},
        {"z'", [](auto& r) { r[0].z = nan; }},
        {"colour", [](auto& r) { r[1].g = inf; }},
        {"colour", [](auto& r) { r[1].b = nan; }},
        {"W", [](auto& r) { r[1].w.yy = inf; }},
        {"W", [](auto& r) { r[1].w.xy = nan; }},
        {"node.path", [](auto& r) { r[1].path = NodePath(3); }},
        {"twice", [](auto& r) { r[1] = r[0]; }},
        {"order",
         [](auto& r) {
             r.push_back(r[1]);
             r[2].y = 7.25F;
         }},
        {"primary", [](auto& r) { r[1].path = NodePath().child(Bounce::reflected); }},
    };
    for (const BadPixel& c : cases) {
        std::vector<Record> records = good;
        c.damage(records);
        const char* problem = problem_of_pixel(records, -3, 7, all);
        ASSERT_NE(problem, nullptr) << c.part_of_message;
        EXPECT_NE(std::strstr(problem, c.part_of_message), nullptr) << problem;
    }
}

TEST(RecordCheck, InfinityIsADepthAndChannelsMustExist) {
    std::vector<Record> records{record_at(0, 0)};
    records[0].z = inf;
    EXPECT_EQ(problem_of_pixel(records, 0, 0, {}), nullptr);
    records.push_back(records[0]);
    records[1].path = NodePath().child(Bounce::reflected);
    EXPECT_NE(problem_of_pixel(records, 0, 0, {false, true}), nullptr);
    EXPECT_EQ(problem_of_pixel(records, 0, 0, {true, false}), nullptr);
    records[1].path = NodePath();
    records[1].layer = 1;
    EXPECT_NE(problem_of_pixel(records, 0, 0, {true, false}), nullptr);
    EXPECT_EQ(problem_of_pixel(records, 0, 0, {false, true}), nullptr);
}

}  // namespace
}  // namespace postlens::test::record_test
