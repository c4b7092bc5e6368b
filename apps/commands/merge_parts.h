// The parts that `merge` joins, with any contents: finds out which share each part is, and whether the parts
// belong to the same command.
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

/// Throws Error(invalid_input) if two parts are not from shares of the same command.
void check_same_work(const PartFacts& first, const PartFacts& other);

/// The parts that were found, by share. Throws Error(invalid_input) if two parts have the same share.
class FoundParts {
  public:
    void add(const PartFacts& part);
    /// Numbers of the shares whose parts are missing. Throws if there are any, unless `partial` is set.
    [[nodiscard]] std::vector<int> missing(int count, bool partial) const;

  private:
    std::map<int, std::string> names_;
};

/// "0/8, 3/8"; a long list is cut short.
[[nodiscard]] std::string listed(const std::vector<int>& shares, int count);

/// Joins parts of a trace, which are sample files, to the sample file of the undivided trace.
[[nodiscard]] CommandResult merge_traces(const MergeOptions& options);

/// Joins the results that the shares of a sweep or a chart have written into one folder. The parts are the
/// tables of the shares, FOLDER/*.I-of-N.json; the output is the folder.
[[nodiscard]] CommandResult merge_items(const MergeOptions& options);

}  // namespace postlens
