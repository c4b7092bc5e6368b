#include "pictures/foreign/channel_names.h"

#include <algorithm>

namespace postlens {

std::string first_channel(const ForeignPart& part, const ChannelNames& names) {
    for (const std::string& name : names) {
        if (part.has(name)) return name;
    }
    return "";
}

std::pair<std::string, std::string> split_channel(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    return dot == std::string::npos ? std::pair(std::string(), name)
                                    : std::pair(name.substr(0, dot + 1), name.substr(dot + 1));
}

bool has_any_word(const std::vector<std::string>& words, std::initializer_list<std::string_view> some) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& w) {
        return std::find(some.begin(), some.end(), w) != some.end();
    });
}

}  // namespace postlens
