#include "records/record.h"

namespace postlens {

std::string NodePath::text() const {
    if (bits_ == 0) return "primary";
    std::string letters;
    for (std::uint32_t b = bits_; b != 0; b >>= 2) letters += "?RT?"[b & 3U];
    return letters;
}

}  // namespace postlens
