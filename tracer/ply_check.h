// Whether a PLY file holds what its header says.
#pragma once

#include <string>
#include <string_view>

namespace postlens {

/// Walks through the whole file, ASCII or binary. assimp trusts the counts in it: it takes as much memory as
/// they ask for and makes vertices of bytes that are not there. Throws Error(invalid_input) "FILE[:LINE]:
/// ...".
void check_ply(std::string_view bytes, const std::string& file);

}  // namespace postlens
