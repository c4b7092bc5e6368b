// The parts that `merge` joins, whatever they hold: which share each is, and whether they belong together.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

using Json = nlohmann::ordered_json;

/// Reads the share from the mark of a part (mark_of in share.h). Throws Error(invalid_input) for a mark that
/// postlens has not written.
[[nodiscard]] Share share_in(const Json& mark, const std::string& name);

/// Description of a part without its contents.
struct PartFacts {  // NOLINT(bugprone-exception-escape): assertions inside of the JSON library
    std::string name;
    Json mark;
    Share share;
};

/// Throws Error(invalid_input) if two parts do not belong to the same work.
void check_same_work(const PartFacts& first, const PartFacts& other);

/// The parts that were found, by share. Throws Error(invalid_input) if two parts have the same share.
class FoundParts {
  public:
    void add(const PartFacts& part);
    /// Shares without a part; throws if there are any, unless `partial`.
    [[nodiscard]] std::vector<int> missing(int count, bool partial) const;

  private:
    std::map<int, std::string> names_;
};

/// "0/8, 3/8"; a long list is cut short.
[[nodiscard]] std::string listed(const std::vector<int>& shares, int count);

/// Joins parts of a trace, which are sample files, to the sample file of the undivided trace.
[[nodiscard]] CommandResult merge_traces(const MergeOptions& options);

/// Joins the items that the shares of a sweep or a chart have left in one folder. The parts are the shares'
/// tables, FOLDER/*.I-of-N.json; the output is the folder.
[[nodiscard]] CommandResult merge_items(const MergeOptions& options);

}  // namespace postlens
