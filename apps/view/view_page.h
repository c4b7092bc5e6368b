// The files of the viewer's page. They are compiled into the program from the folder viewer/.
#pragma once

#include <optional>
#include <string_view>

namespace postlens {

struct PageFile {
    std::string_view text;
    const char* type;
};

/// Returns the file with the given name in viewer/, or an empty value if there is none.
[[nodiscard]] std::optional<PageFile> page_file(std::string_view name);

}  // namespace postlens
