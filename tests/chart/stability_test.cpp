// All cases of tests/stability: the tested method and its remedy must meet the limits in the case file.
#include <cctype>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "chart/atlas/atlas_run.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::stability_test {
namespace {

namespace fs = std::filesystem;

class Stability : public testing::TestWithParam<fs::path> {};

TEST_P(Stability, HoldsWhatTheCaseSays) {
    AtlasCase c = read_atlas_case(GetParam());
    if (c.named_at_least == 0) c.cause = "none";  // finding causes takes longest
    const fs::path work = fs::temp_directory_path() / fmt::format("postlens_{}_{}", c.name, ::getpid());
    fs::create_directories(work);
    const AtlasResult r = run_atlas_case(c, work);
    fs::remove_all(work);
    for (const std::string& line : broken_expectations(c, r)) ADD_FAILURE() << c.name << ": " << line;
    RecordProperty("method_db", std::to_string(r.method.error.psnr_db));
    RecordProperty("pinhole_db", std::to_string(r.pinhole_db));
}

INSTANTIATE_TEST_SUITE_P(Atlas, Stability, testing::ValuesIn(atlas_case_files(POSTLENS_STABILITY)),
                         [](const auto& of) { return of.param.stem().string(); });

}  // namespace
}  // namespace postlens::test::stability_test
