#include "tracer/ply_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text.h"

namespace postlens {
namespace {

struct Property {
    std::size_t bytes = 0;        // of a value, or of an entry of a list
    std::size_t count_bytes = 0;  // of the number of entries; 0: no list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

enum class Format { ascii, little_endian, big_endian };

std::size_t bytes_of(std::string_view type) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 16> types{{{"char", 1},
                                                                              {"int8", 1},
                                                                              {"uchar", 1},
                                                                              {"uint8", 1},
                                                                              {"short", 2},
                                                                              {"int16", 2},
                                                                              {"ushort", 2},
                                                                              {"uint16", 2},
                                                                              {"int", 4},
                                                                              {"int32", 4},
                                                                              {"uint", 4},
                                                                              {"uint32", 4},
                                                                              {"float", 4},
                                                                              {"float32", 4},
                                                                              {"double", 8},
                                                                              {"float64", 8}}};
    for (const auto& [name, bytes] : types) {
        if (type == name) return bytes;
    }
    return 0;
}

class PlyCheck {
  public:
    PlyCheck(std::string_view bytes, const std::string& file) : rest_(bytes), file_(file) {}

    void check() {
        read_header();
        for (const Element& e : elements_) {
            if (e.properties.empty() && e.count > 0)
                fail_here("element {} has no properties", excerpt(e.name));
            for (std::uint64_t i = 0; i < e.count; ++i) {
                for (const Property& p : e.properties)
                    format_ == Format::ascii ? skip_words(e, p) : skip_bytes(e, p);
            }
        }
    }

  private:
    template <typename... Args>
    [[noreturn]] void fail_here(fmt::format_string<Args...> text, Args&&... args) const {
        fail(ExitCode::invalid_input, "{}: {}", file_, fmt::format(text, std::forward<Args>(args)...));
    }

    // Lines end with \n, \r\n or \r.
    std::vector<std::string_view> header_line() {
        const std::size_t end = rest_.find_first_of("\r\n");
        if (end == std::string_view::npos || end > 4096)
            fail_here("has no end_header (expected a PLY header)");
        const std::string_view line = rest_.substr(0, end);
        const bool two = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
        rest_.remove_prefix(end + (two ? 2 : 1));
        std::vector<std::string_view> words;
        for (std::size_t at = 0; at < line.size();) {
            const std::size_t from = line.find_first_not_of(" \t", at);
            if (from == std::string_view::npos) break;
            at = std::min(line.find_first_of(" \t", from), line.size());
            words.push_back(line.substr(from, at - from));
        }
        return words;
    }

    void read_header() {
        const auto magic = header_line();
        if (magic.size() != 1 || magic[0] != "ply")
            fail_here("is no PLY file (expected 'ply' in its first line)");
        bool has_format = false;
        for (;;) {
            const auto words = header_line();
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "end_header") break;
            if (words[0] == "format" && words.size() >= 2) {
                has_format = true;
                format_ =
                    words[1] == "ascii"                  ? Format::ascii
                    : words[1] == "binary_little_endian" ? Format::little_endian
                    : words[1] == "binary_big_endian"
                        ? Format::big_endian
                        : (fail_here("has an unknown format (got {})", excerpt(words[1])), Format::ascii);
            } else if (words[0] == "element" && words.size() == 3) {
                elements_.push_back({std::string(words[1]), whole(words[2]), {}});
            } else if (words[0] == "property" && !elements_.empty() && words.size() >= 3) {
                elements_.back().properties.push_back(property(words));
            } else {
                fail_here("has a header line that is not understood (got {})", excerpt(words[0]));
            }
        }
        if (!has_format) fail_here("has no format line in its header");
    }

    [[nodiscard]] Property property(const std::vector<std::string_view>& words) const {
        const bool list = words[1] == "list";
        if (words.size() != (list ? 5U : 3U)) fail_here("has a property that is not understood");
        const Property p{bytes_of(words[list ? 3 : 1]), list ? bytes_of(words[2]) : 0};
        if (p.bytes == 0 || (list && p.count_bytes == 0)) {
            fail_here("has a property of an unknown type (got {})", excerpt(words[list ? 3 : 1]));
        }
        return p;
    }

    [[nodiscard]] std::uint64_t whole(std::string_view word) const {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) {
            fail_here("has a count that is no whole number (got {})", excerpt(word));
        }
        return value;
    }

    void need(const Element& e, std::uint64_t bytes) const {
        if (bytes > rest_.size())
            fail_here("ends in its element {} (expected {} of them)", excerpt(e.name), e.count);
    }

    void skip_bytes(const Element& e, const Property& p) {
        std::uint64_t count = 1;
        if (p.count_bytes > 0) {
            need(e, p.count_bytes);
            count = 0;
            for (std::size_t i = 0; i < p.count_bytes; ++i) {
                const std::size_t at = format_ == Format::little_endian ? p.count_bytes - 1 - i : i;
                count = count << 8 | static_cast<unsigned char>(rest_[at]);
            }
            rest_.remove_prefix(p.count_bytes);
            if (count > rest_.size()) need(e, count);
        }
        need(e, count * p.bytes);
        rest_.remove_prefix(static_cast<std::size_t>(count * p.bytes));
    }

    std::string_view word(const Element& e) {
        const std::size_t from = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
        rest_.remove_prefix(from);
        need(e, 1);
        const std::size_t end = std::min(rest_.find_first_of(" \t\r\n"), rest_.size());
        const std::string_view out = rest_.substr(0, end);
        rest_.remove_prefix(end);
        return out;
    }

    void skip_words(const Element& e, const Property& p) {
        const std::uint64_t count = p.count_bytes > 0 ? whole(word(e)) : 1;
        need(e, count);
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::string_view w = word(e);
            if (!parse_number(w)) fail_here("has something else than a number (got {})", excerpt(w));
        }
    }

    std::string_view rest_;
    const std::string& file_;
    Format format_ = Format::ascii;
    std::vector<Element> elements_;
};

}  // namespace

void check_ply(std::string_view bytes, const std::string& file) {
    PlyCheck(bytes, file).check();
}

}  // namespace postlens
