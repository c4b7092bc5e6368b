#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/share.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/picture_part.h"
#include "records/lost_rows.h"

namespace postlens {

namespace {

void warn_of_share(const std::string& mark, const std::string& what, const std::string& lacks,
                   std::vector<Warning>& out) {
    const std::optional<Share> share = share_of_mark(mark);
    if (!share || share->count == 1) return;
    out.push_back({"part",
                   fmt::format("{} is part {}/{} of {} (expected the whole, by `postlens merge`)", what,
                               share->index, share->count, lacks),
                   1 - 1.0 / share->count});
}

}  // namespace

void warn_of_part(const std::string& picture, std::vector<Warning>& out) {
    if (!is_openexr(picture)) return;
    warn_of_share(read_part_mark(picture), picture,
                  "a picture, and lacks the rows or the samples of the others", out);
}

void warn_of_missing_rows(const SampleFileReader& file, std::vector<Warning>& out) {
    warn_of_share(file.header().made_by, "the file", "a trace: nothing is seen in the rows of the others",
                  out);
    const std::span<const LostRows> lost = file.lost_rows();
    const std::span<const double> gone_s = file.lost_instants_s();
    if (lost.empty() && gone_s.empty()) return;
    const auto rows = static_cast<std::size_t>(file.y_end() - file.y_begin());
    std::size_t lost_count = rows * gone_s.size();
    std::string text;
    for (std::size_t i = 0; i < file.instants(); ++i) {
        std::vector<LostRows> runs;
        for (const LostRows& run : lost) {
            if (run.instant != i) continue;
            runs.push_back(run);
            lost_count += static_cast<std::size_t>(run.y_end - run.y_begin);
        }
        if (runs.empty()) continue;
        if (!text.empty()) text += "; ";
        if (i > 0) text += fmt::format("at {:.6g} s ", file.instant_s(i));
        text += rows_text(runs) + " lost";
    }
    if (!gone_s.empty())
        text += fmt::format("{}nothing left of {:.6g} s", text.empty() ? "" : "; ", fmt::join(gone_s, ", "));
    const auto all = rows * (file.instants() + gone_s.size());
    out.push_back({"salvaged",
                   fmt::format("the file is damaged: {} (of rows {} to {}); nothing is seen there", text,
                               file.y_begin(), file.y_end() - 1),
                   static_cast<double>(lost_count) / static_cast<double>(all)});
}

}  // namespace postlens
