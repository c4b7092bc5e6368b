#include "chart/atlas/atlas_folder.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/files/folder.h"
#include "core/files/output_file.h"
#include "core/files/text_file.h"
#include "core/json_dump.h"
#include "core/progress.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_text_bytes = 1U << 20U;

}  // namespace

fs::path atlas_strip(const std::string& name) {
    return fs::path("images") / "failures" / (name + ".png");
}

AtlasRun run_atlas(const fs::path& cases, const fs::path& folder, bool restart) {
    AtlasRun out;
    // Reads all cases before any is run, so that mistakes in any file are reported immediately.
    for (const fs::path& path : atlas_case_files(cases)) out.entries.push_back({read_atlas_case(path), {}});
    if (fs::exists(cases / "introduction.md"))
        out.introduction = read_text_file(cases / "introduction.md", largest_text_bytes);
    make_folder(folder);
    for (const char* name : {"cases", "images", "images/failures"}) make_folder(folder / name);
    Progress progress("atlas", out.entries.size());
    for (AtlasEntry& e : out.entries) {
        const fs::path json = folder / "cases" / (e.what.name + ".json");
        const fs::path strip = folder / atlas_strip(e.what.name);
        bool is_kept = false;
        if (!restart && fs::exists(json) && fs::exists(strip)) {
            e.result = atlas_from_json(read_text_file(json, largest_text_bytes), json);
            is_kept = e.result.key == atlas_key(e.what);
        }
        if (is_kept) {
            ++out.kept;
        } else {
            e.result = run_atlas_case(e.what, folder / "cases", strip);
            write_file(json, json_dump(to_json(e.result), 1) + "\n");
        }
        for (const std::string& line : broken_expectations(e.what, e.result))
            out.broken.push_back(e.what.name + ": " + line);
        progress.advance();
    }
    return out;
}

}  // namespace postlens
