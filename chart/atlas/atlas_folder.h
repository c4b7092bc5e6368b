// Runs all atlas cases of a folder. An interrupted run resumes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/atlas/atlas_case.h"
#include "chart/atlas/atlas_run.h"

namespace postlens {

struct AtlasEntry {
    AtlasCase what;
    AtlasResult result;
};

struct AtlasRun {
    std::vector<AtlasEntry> entries;  ///< sorted by name
    std::size_t kept = 0;             ///< number of cases whose results come from an earlier run
    std::vector<std::string> broken;  ///< "CASE: METHOD: ..." for each failed expectation
    std::string introduction;         ///< text of introduction.md in the cases' folder; may be empty
};

/// Returns the path of a picture that shows the images of the test case `name` side by side, relative to
/// run_atlas's output folder.
[[nodiscard]] std::filesystem::path atlas_strip(const std::string& name);

/// Runs all test cases in the folder `cases`. For each case NAME, writes the result to cases/NAME.json and a
/// picture to atlas_strip(NAME), both within `folder`. An earlier result in `folder` is kept if it has the
/// same atlas_key, i.e. if nothing has changed on which it depends. If `restart` is true, all cases are run
/// again.
///
/// Throws the errors of read_atlas_case and run_atlas_case, and Error(interrupted).
[[nodiscard]] AtlasRun run_atlas(const std::filesystem::path& cases, const std::filesystem::path& folder,
                                 bool restart);

}  // namespace postlens
