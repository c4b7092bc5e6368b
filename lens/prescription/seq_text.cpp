#include "lens/prescription/seq_text.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "lens/prescription/formats.h"

namespace postlens {
namespace {

// Removes the comment from a line. A comment begins at the first ! outside quotes.
std::string_view without_remark(std::string_view line) {
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (quote != 0) {
            if (line[i] == quote) quote = 0;
        } else if (line[i] == '"' || line[i] == '\'') {
            quote = line[i];
        } else if (line[i] == '!') {
            return line.substr(0, i);
        }
    }
    return line;
}

// Splits a line into commands at the semicolons outside quotes.
std::vector<std::string_view> commands_of(std::string_view line) {
    std::vector<std::string_view> out;
    char quote = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i == line.size() || (quote == 0 && line[i] == ';')) {
            out.push_back(line.substr(begin, i - begin));
            begin = i + 1;
        } else if (quote != 0) {
            if (line[i] == quote) quote = 0;
        } else if (line[i] == '"' || line[i] == '\'') {
            quote = line[i];
        }
    }
    return out;
}

}  // namespace

std::vector<std::pair<int, std::string>> seq_commands(const std::string& text, const std::string& file) {
    std::vector<std::pair<int, std::string>> commands;
    std::string continued;
    for (const TextLine& line : lines_of(text)) {
        std::string_view content = without_remark(line.text);
        const std::size_t last = content.find_last_not_of(" \t");
        const bool goes_on = last != std::string_view::npos && content[last] == '&';
        if (goes_on) content = content.substr(0, last);
        if (continued.size() + content.size() > 100'000) {
            fail(ExitCode::invalid_input, "{}:{}: a command of more than 100000 characters", file,
                 line.number);
        }
        continued += content;
        continued += ' ';
        if (goes_on) continue;
        for (const std::string_view command : commands_of(continued)) {
            if (!words_of(command).empty()) commands.emplace_back(line.number, command);
        }
        continued.clear();
    }
    return commands;
}

std::string upper_case(std::string_view word) {
    std::string out(word);
    std::transform(out.begin(), out.end(), out.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return out;
}

double seq_number(const std::string& file, int line, const SeqWords& words, std::size_t i,
                  std::string_view what) {
    if (i >= words.size()) {
        fail(ExitCode::invalid_input, "{}:{}: {} is missing (got {} words; expected {})", file, line, what,
             words.size(), i + 1);
    }
    return number_in(file, line, words[i], what);
}

void seq_unsupported(const std::string& file, int line, std::string_view what) {
    fail(ExitCode::invalid_input, "{}:{}: {} (expected a lens of centred surfaces)", file, line, what);
}

}  // namespace postlens
