#include "scene/nff/nff_tokens.h"

#include <algorithm>
#include <cmath>

#include "core/files/text_file.h"
#include "core/text.h"

namespace postlens {
namespace {

// Greatest length of a line, in characters. Lines of published NFF files have at most 60.
constexpr std::size_t longest_line = std::size_t{1} << 16;
constexpr std::size_t chunk_bytes = std::size_t{1} << 16;
constexpr std::string_view blanks = " \t\r\v\f";

}  // namespace

NffTokens::NffTokens(const std::filesystem::path& path) : path_(path) {
    check_regular_file(path);
    file_.open(path, std::ios::binary);
    if (!file_) fail(ExitCode::invalid_input, "{}: cannot read", path.string());
}

bool NffTokens::fill() {
    chunk_.resize(chunk_bytes);
    file_.read(chunk_.data(), static_cast<std::streamsize>(chunk_bytes));
    if (file_.bad()) fail(ExitCode::invalid_input, "{}: cannot read", path_.string());
    chunk_.resize(static_cast<std::size_t>(file_.gcount()));
    chunk_at_ = 0;
    digest_.add(chunk_);
    return !chunk_.empty();
}

bool NffTokens::read_line() {
    text_.clear();
    words_.clear();
    word_at_ = 0;
    if (chunk_at_ == chunk_.size() && !fill()) return false;
    ++line_;
    for (;;) {
        const std::size_t end = chunk_.find('\n', chunk_at_);
        text_.append(chunk_, chunk_at_, end == std::string::npos ? end : end - chunk_at_);
        if (text_.size() > longest_line) {
            fail(ExitCode::invalid_input, "{}:{}: the line is too long (expected at most {} characters)",
                 path_.string(), line_, longest_line);
        }
        chunk_at_ = end == std::string::npos ? chunk_.size() : end + 1;
        if (end != std::string::npos || !fill()) break;
    }
    std::string_view text = std::string_view(text_).substr(0, text_.find('#'));
    if (line_ == 1) text = without_byte_order_mark(text);
    for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
        words_.push_back(text.substr(at, end - at));
        at = text.find_first_not_of(blanks, end);
    }
    return true;
}

std::optional<std::string_view> NffTokens::peek() {
    while (word_at_ == words_.size()) {
        if (!read_line()) return std::nullopt;
    }
    return words_[word_at_];
}

std::optional<std::string_view> NffTokens::next() {
    const auto word = peek();
    if (word) {
        ++word_at_;
        taken_line_ = line_;
    }
    return word;
}

std::vector<std::string> NffTokens::rest_of_line() {
    std::vector<std::string> rest;
    // Returns the remaining words of the line `taken_line_`, on which the last word was taken. If this line
    // has no more words, peek() may have read the next line already. Then `words_` holds the next line's
    // words, which must not be returned.
    while (line_ == taken_line_ && word_at_ < words_.size()) rest.emplace_back(words_[word_at_++]);
    return rest;
}

double NffTokens::number(std::string_view what, double largest) {
    const auto word = next();
    if (!word) fail_here("{}: the file ends too early (expected a number)", what);
    return number(*word, what, largest);
}

double NffTokens::number(std::string_view word, std::string_view what, double largest) const {
    const std::optional<double> value = parse_number(word);
    if (!value) fail_here("{} is not a number (got {})", what, excerpt(word));
    if (!(std::abs(*value) <= largest)) {
        fail_here("{} is out of range (got {}; expected a finite number up to {:g})", what, excerpt(word),
                  largest);
    }
    return *value;
}

}  // namespace postlens
