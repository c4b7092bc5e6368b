// Finds out which share of the work each result file (part) contains. Checks that all parts come from the
// same command.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Returns which share of a command's work the file `name` contains, if several machines divided the work
/// (--share I/N). The share is read from `mark`, the JSON in the file's metadata. Throws Error(invalid_input)
/// if `mark` is not in the format of mark_of (share.h).
[[nodiscard]] Share share_in(const nlohmann::ordered_json& mark, const std::string& name);

/// Description of a part without its contents.
struct PartFacts {  // NOLINT(bugprone-exception-escape): assertions inside of the JSON library
    std::string name;
    nlohmann::ordered_json mark;
    Share share;
};

/// Throws Error(invalid_input) if the two parts come from different commands.
void check_same_work(const PartFacts& first, const PartFacts& other);

/// The result files that `merge` joins, in the order of their shares of the work. `add` throws
/// Error(invalid_input) if two files contain the same share.
class FoundParts {
  public:
    void add(const PartFacts& part);
    /// Returns the numbers (0 to count - 1) of the shares for which `add` has not received a result file.
    /// `count` is the number of machines that divided the command, each with one share. If a file is missing
    /// and `partial` is false, throws an error.
    [[nodiscard]] std::vector<int> missing(int count, bool partial) const;

  private:
    std::map<int, std::string> names_;
};

/// Lists shares of the work as text: "0/8, 3/8" if `shares` is {0, 3} and `count` is 8. A long list is cut
/// short.
[[nodiscard]] std::string listed(const std::vector<int>& shares, int count);

/// Joins the sample files into which a trace was divided. The result is the file that an undivided trace
/// would write.
[[nodiscard]] CommandResult merge_traces(const MergeOptions& options);

/// Joins the results of a sweep or a chart that several machines computed in the same folder. `options.parts`
/// are the tables *.I-of-N.json that these machines wrote. The result is written to their folder.
[[nodiscard]] CommandResult merge_items(const MergeOptions& options);

}  // namespace postlens
