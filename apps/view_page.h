// The viewer's page, which the program carries (viewer/).
#pragma once

#include <optional>
#include <string_view>

namespace postlens {

struct PageFile {
    std::string_view text;
    const char* type;
};

/// One of the page's files by its name in viewer/.
[[nodiscard]] std::optional<PageFile> page_file(std::string_view name);

}  // namespace postlens
