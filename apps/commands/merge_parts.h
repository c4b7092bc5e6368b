// The parts that `merge` joins. Each part is the result file of one share of a command. These functions find
// out which share a part contains, and check that all parts come from the same command.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Returns the index of the share and the number of shares, which it reads from `mark`, the JSON that
/// describes a part (mark_of in share.h). Throws Error(invalid_input) if postlens has not written the JSON.
[[nodiscard]] Share share_in(const nlohmann::ordered_json& mark, const std::string& name);

/// Description of a part without its contents.
struct PartFacts {  // NOLINT(bugprone-exception-escape): assertions inside of the JSON library
    std::string name;
    nlohmann::ordered_json mark;
    Share share;
};

/// Throws Error(invalid_input) if the two parts come from different commands.
void check_same_work(const PartFacts& first, const PartFacts& other);

/// Lists the parts that were found, in the order of their shares. Throws Error(invalid_input) if two parts
/// contain the same share.
class FoundParts {
  public:
    void add(const PartFacts& part);
    /// Returns the indices of the shares for which there is no part. Throws if there are any, unless
    /// `partial` is set.
    [[nodiscard]] std::vector<int> missing(int count, bool partial) const;

  private:
    std::map<int, std::string> names_;
};

/// Returns a text such as "0/8, 3/8". A long list is cut short.
[[nodiscard]] std::string listed(const std::vector<int>& shares, int count);

/// Joins the parts of a trace, which are sample files. The result is the sample file that an undivided trace
/// would write.
[[nodiscard]] CommandResult merge_traces(const MergeOptions& options);

/// Joins the results that the shares of a sweep or a chart have written into one folder. Each share has
/// written a table named FOLDER/*.I-of-N.json. These tables are the parts that are joined. The joined result
/// is written to the same folder.
[[nodiscard]] CommandResult merge_items(const MergeOptions& options);

}  // namespace postlens
