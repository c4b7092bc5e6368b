#include "apps/commands/merge_parts.h"

#include <algorithm>

#include "apps/share.h"
#include "core/counted.h"

namespace postlens {

Share share_in(const nlohmann::ordered_json& mark, const std::string& name) {
    const auto numbers = [&mark](const char* key, std::size_t count) {
        const auto at = mark.find(key);
        return at != mark.end() && at->is_array() && at->size() == count &&
               std::all_of(at->begin(), at->end(),
                           [](const nlohmann::ordered_json& n) { return n.is_number_integer(); });
    };
    const bool whole = mark.is_object() && numbers("share", 2) && mark.contains("made_by") &&
                       mark["made_by"].is_object() && mark.contains("crop") &&
                       (mark["crop"].is_null() || numbers("crop", 4));
    if (!whole) fail(ExitCode::invalid_input, "{}: is a damaged part (its mark is not ours)", name);
    const auto index = mark["share"][0].get<std::int64_t>(), count = mark["share"][1].get<std::int64_t>();
    if (!is_share(index, count))
        fail(ExitCode::invalid_input, "{}: is a damaged part (got share {}/{})", name, index, count);
    return {static_cast<int>(index), static_cast<int>(count)};
}

void check_same_work(const PartFacts& first, const PartFacts& other) {
    if (other.share.count != first.share.count) {
        fail(ExitCode::invalid_input, "{}: is one of {} (expected one of {}, as {})", other.name,
             counted(other.share.count, "part"), first.share.count, first.name);
    }
    if (const std::string difference = first_difference(other.mark["made_by"], first.mark["made_by"]);
        !difference.empty()) {
        fail(ExitCode::invalid_input, "{}: is a part of something else than {}: {}", other.name, first.name,
             difference);
    }
    if (other.mark["crop"] != first.mark["crop"])
        fail(ExitCode::invalid_input, "{}: has another crop than {}", other.name, first.name);
}

void FoundParts::add(const PartFacts& part) {
    if (const auto [at, is_new] = names_.try_emplace(part.share.index, part.name); !is_new) {
        fail(ExitCode::invalid_input, "{}: is the same part as {} (got {}/{} twice)", part.name, at->second,
             part.share.index, part.share.count);
    }
}

std::string listed(const std::vector<int>& shares, int count) {
    constexpr std::size_t most = 8;
    std::string out;
    for (std::size_t i = 0; i < std::min(shares.size(), most); ++i)
        out += fmt::format("{}{}/{}", i == 0 ? "" : ", ", shares[i], count);
    return shares.size() > most ? fmt::format("{} and {} more", out, shares.size() - most) : out;
}

std::vector<int> FoundParts::missing(int count, bool partial) const {
    std::vector<int> out;
    for (int i = 0; i < count; ++i) {
        if (!names_.contains(i)) out.push_back(i);
    }
    if (!out.empty() && !partial) {
        fail(ExitCode::invalid_input,
             "parts are missing (got {} of {}; expected also {}; --partial merges what is there)",
             names_.size(), count, listed(out, count));
    }
    return out;
}

}  // namespace postlens
