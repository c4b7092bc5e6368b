// Runs every case of a folder and keeps what is finished.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/atlas_case.h"
#include "chart/atlas_run.h"

namespace postlens {

struct AtlasEntry {
    AtlasCase what;
    AtlasResult result;
};

struct AtlasRun {
    std::vector<AtlasEntry> entries;  ///< by name
    std::size_t kept = 0;             ///< that an earlier run had finished
    std::vector<std::string> broken;  ///< "CASE: METHOD: ..." for what is not as expected
    std::string introduction;         ///< introduction.md of the cases' folder; empty without it
};

/// Where a case's picture strip lies in an atlas's folder, relative to it.
[[nodiscard]] std::filesystem::path atlas_strip(const std::string& name);

/// Runs the cases of `cases` into `folder`, which is made if its parent exists: cases/NAME.json and
/// atlas_strip(NAME), each after its case; those of an earlier run with the same case file, scene and version
/// are kept unless `restart`. Throws Error(interrupted) after keeping what is finished, and what
/// read_atlas_case and run_atlas_case throw.
[[nodiscard]] AtlasRun run_atlas(const std::filesystem::path& cases, const std::filesystem::path& folder,
                                 bool restart);

}  // namespace postlens
