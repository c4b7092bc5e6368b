#include "scene/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace postlens {
namespace {

PlyType type_of(std::string_view name) {
    using enum PlyType;
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> types{{{"char", int8},
                                                                          {"int8", int8},
                                                                          {"uchar", uint8},
                                                                          {"uint8", uint8},
                                                                          {"short", int16},
                                                                          {"int16", int16},
                                                                          {"ushort", uint16},
                                                                          {"uint16", uint16},
                                                                          {"int", int32},
                                                                          {"int32", int32},
                                                                          {"uint", uint32},
                                                                          {"uint32", uint32},
                                                                          {"float", float32},
                                                                          {"float32", float32},
                                                                          {"double", float64},
                                                                          {"float64", float64}}};
    for (const auto& [written, type] : types) {
        if (name == written) return type;
    }
    return none;
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t from = line.find_first_not_of(" \t", at);
        if (from == std::string_view::npos) break;
        at = std::min(line.find_first_of(" \t", from), line.size());
        words.push_back(line.substr(from, at - from));
    }
    return words;
}

class HeaderReader {
  public:
    HeaderReader(std::string_view& rest, const std::string& file) : rest_(rest), file_(file) {}

    PlyHeader read() {
        if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
        const std::size_t end = rest_.find_first_of("\r\n");
        if (end == std::string_view::npos ||
            words_of(rest_.substr(0, end)) != std::vector<std::string_view>{"ply"})
            fail_here("is no PLY file (expected 'ply' in its first line)");
        end_of_line_ = rest_[end] == '\r' && rest_.substr(end, 2) != "\r\n" ? '\r' : '\n';
        (void)line();
        bool has_format = false;
        for (;;) {
            const std::string_view text = line();
            const auto words = words_of(text);
            if (words.empty() || words[0] == "obj_info") continue;
            if (words[0] == "end_header") break;
            if (words[0] == "comment") {
                read_comment(text, words);
            } else if (words[0] == "format" && words.size() >= 2) {
                has_format = true;
                header_.format = format(words[1]);
            } else if (words[0] == "element" && words.size() == 3) {
                header_.elements.push_back({std::string(words[1]), whole(words[2]), {}});
            } else if (words[0] == "property" && !header_.elements.empty() && words.size() >= 3) {
                header_.elements.back().properties.push_back(property(words));
            } else {
                fail_here(
                    "has a header line that is not understood (got {}; expected format, element, property, "
                    "comment, obj_info or end_header)",
                    excerpt(text));
            }
        }
        if (!has_format) fail_here("has no format line in its header");
        return std::move(header_);
    }

  private:
    template <typename... Args>
    [[noreturn]] void fail_here(fmt::format_string<Args...> text, Args&&... args) const {
        fail(ExitCode::invalid_input, "{}: {}", file_, fmt::format(text, std::forward<Args>(args)...));
    }

    std::string_view line() {
        const std::size_t end = rest_.find(end_of_line_);
        if (end == std::string_view::npos) fail_here("has no end_header (expected a PLY header)");
        std::string_view out = rest_.substr(0, end);
        if (out.ends_with('\r')) out.remove_suffix(1);
        rest_.remove_prefix(end + 1);
        return out;
    }

    void read_comment(std::string_view text, const std::vector<std::string_view>& words) {
        if (words.size() < 3 || words[1] != "TextureFile" || !header_.texture_file.empty()) return;
        const auto from = static_cast<std::size_t>(words[2].data() - text.data());
        const std::size_t to = text.find_last_not_of(" \t") + 1;
        header_.texture_file = text.substr(from, to - from);
    }

    [[nodiscard]] PlyFormat format(std::string_view word) const {
        if (word == "ascii") return PlyFormat::ascii;
        if (word == "binary_little_endian") return PlyFormat::little_endian;
        if (word == "binary_big_endian") return PlyFormat::big_endian;
        fail_here("has an unknown format (got {}; expected ascii, binary_little_endian or binary_big_endian)",
                  excerpt(word));
    }

    [[nodiscard]] PlyProperty property(const std::vector<std::string_view>& words) const {
        const bool is_list = words[1] == "list";
        if (words.size() != (is_list ? 5U : 3U)) {
            fail_here("has a property that is not understood (got {} words; expected {})", words.size(),
                      is_list ? 5 : 3);
        }
        for (const std::string_view word : {words[is_list ? 2 : 1], words[is_list ? 3 : 1]}) {
            if (type_of(word) == PlyType::none) {
                fail_here(
                    "has a property of an unknown type (got {}; expected char, uchar, short, ushort, int, "
                    "uint, "
                    "float or double)",
                    excerpt(word));
            }
        }
        return {std::string(words.back()), type_of(words[is_list ? 3 : 1]),
                is_list ? type_of(words[2]) : PlyType::none};
    }

    [[nodiscard]] std::uint64_t whole(std::string_view word) const {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) {
            fail_here("has an element whose count is no whole number (got {})", excerpt(word));
        }
        return value;
    }

    std::string_view& rest_;
    const std::string& file_;
    char end_of_line_ = '\n';
    PlyHeader header_;
};

}  // namespace

std::size_t bytes_of(PlyType type) {
    switch (type) {
        case PlyType::none:
            return 0;
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::int32:
        case PlyType::uint32:
        case PlyType::float32:
            return 4;
        case PlyType::float64:
            return 8;
    }
    return 0;
}

PlyHeader take_ply_header(std::string_view& bytes, const std::string& file) {
    return HeaderReader(bytes, file).read();
}

}  // namespace postlens
