// The files of the viewer's page. They lie in viewer/ and are compiled into the program.
#pragma once

#include <optional>
#include <string_view>

namespace postlens {

struct PageFile {
    std::string_view text;
    const char* type;
};

/// The file with the given name in viewer/; empty if there is none.
[[nodiscard]] std::optional<PageFile> page_file(std::string_view name);

}  // namespace postlens
