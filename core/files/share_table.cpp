#include "core/files/share_table.h"

#include <algorithm>
#include <fmt/format.h>

namespace postlens {

std::string share_table_name(std::string_view stem, const Share& share) {
    return fmt::format("{}.{}-of-{}.json", stem, share.index, share.count);
}

std::vector<std::filesystem::path> share_tables(const std::filesystem::path& folder, std::string_view stem) {
    std::vector<std::filesystem::path> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(fmt::format("{}.", stem)) && name.ends_with(".json") &&
            name.find("-of-") != std::string::npos)
            out.push_back(entry.path());
    }
    std::sort(out.begin(), out.end());
    return out;
}

}  // namespace postlens
