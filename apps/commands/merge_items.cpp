#include <algorithm>
#include <filesystem>

#include "apps/commands/merge_parts.h"
#include "apps/share.h"
#include "core/files/file_identity.h"
#include "core/files/text_file.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

namespace fs = std::filesystem;

PartFacts facts_of(const std::string& name) {
    constexpr std::uintmax_t largest_bytes = 64'000'000;
    const Json json = Json::parse(read_text_file(name, largest_bytes), nullptr, false);
    if (!json.is_object() || !json.contains("part")) {
        fail(ExitCode::invalid_input,
             "{}: is no part (expected the table that a sweep or chart with --share has written)", name);
    }
    PartFacts out{name, json["part"], {}};
    out.share = share_in(out.mark, name);
    return out;
}

/// Returns the command line that made the file `part`, the result of one of several machines that divided a
/// `sweep` or a `chart`. This command line is stored in the file. `merge` runs it again to join the files of
/// all machines.
std::vector<std::string> words_in(const PartFacts& part) {
    std::vector<std::string> words = words_of_mark(part.mark);
    const auto foreign = [](const std::string& word) {
        return word.starts_with("--dry-run") || word.starts_with("--share") || word.starts_with("--output") ||
               word.starts_with("-o");
    };
    if (words.empty() || (words[0] != "sweep" && words[0] != "chart") ||
        std::any_of(words.begin(), words.end(), foreign))
        fail(ExitCode::invalid_input, "{}: is a damaged part (its mark is not ours)", part.name);
    return words;
}

}  // namespace

CommandResult merge_items(const MergeOptions& options) {
    FoundParts found;
    PartFacts first;
    for (const std::string& name : options.parts) {
        const PartFacts facts = facts_of(name);
        if (first.name.empty()) first = facts;
        check_same_work(first, facts);
        found.add(facts);
        const fs::path folder = fs::absolute(name).lexically_normal().parent_path();
        if (folder != (fs::absolute(options.output) / "").lexically_normal().parent_path()) {
            fail(ExitCode::wrong_arguments,
                 "--output: not the folder of the parts (got {}; expected {}, which holds {})",
                 options.output, fs::path(name).parent_path().string(), name);
        }
    }
    const int count = first.share.count;
    const std::vector<int> missing = found.missing(count, options.partial);
    std::vector<std::string> words = words_in(first);
    if (words[0] == "sweep" && std::find(words.begin(), words.end(), "--resume") == words.end())
        words.emplace_back("--resume");
    words.insert(words.end(), {"--output", options.output});
    CommandResult out = options.run_words(std::move(words), options.partial ? Join::partial : Join::whole);
    out.json["parts"] = options.parts.size();
    out.json["of"] = count;
    out.json["missing"] = missing;
    if (!missing.empty()) {
        out.warnings.push_back({"partial", fmt::format("parts are missing: {}", listed(missing, count)),
                                static_cast<double>(missing.size()) / count});
    }
    return out;
}

}  // namespace postlens
