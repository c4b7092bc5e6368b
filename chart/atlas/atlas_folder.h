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

/// Runs the test cases of the atlas, a collection of scenes in which a method may fail. They are the files in
/// the folder `cases`. The result of the case NAME is written to cases/NAME.json in `folder`, with a picture
/// of the compared images. A case that already has a result is run again only if something on which the
/// result depends has changed, or if `restart` is true.
///
/// Throws the errors of read_atlas_case and run_atlas_case, and Error(interrupted).
[[nodiscard]] AtlasRun run_atlas(const std::filesystem::path& cases, const std::filesystem::path& folder,
                                 bool restart);

}  // namespace postlens
