#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/text.h"
#include "lens/fits/thin_lens_fit.h"

namespace postlens {

std::vector<CocPair> read_coc_pairs(const std::filesystem::path& path) {
    constexpr std::uintmax_t largest_bytes = 16'000'000;
    std::istringstream text(read_text_file(path, largest_bytes));
    std::vector<CocPair> pairs;
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        if (number == 1) line = std::string(without_byte_order_mark(line));
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty() || line[0] == '#' || (pairs.empty() && line == "distance_m,coc_mm")) continue;
        const std::size_t comma = std::min(line.find(','), line.size());
        const auto distance_m = parse_number(std::string_view(line).substr(0, comma));
        const auto coc_mm = parse_number(std::string_view(line).substr(std::min(comma + 1, line.size())));
        if (!distance_m || !coc_mm || !(*distance_m > 0) || !(*coc_mm >= 0) || std::isinf(*coc_mm)) {
            fail(ExitCode::invalid_input,
                 "{}:{}: not a pair (got {}; expected distance_m,coc_mm, more than 0 and not less than 0)",
                 path.string(), number, excerpt(line));
        }
        pairs.push_back({*distance_m, *coc_mm});
    }
    if (pairs.empty()) {
        fail(ExitCode::invalid_input, "{}: holds no pairs (got none; expected lines distance_m,coc_mm)",
             path.string());
    }
    return pairs;
}

}  // namespace postlens
