#include "lens/prescription/read_prescription.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/files/text_file.h"
#include "core/text.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/formats.h"
#include "lens/prescription/glass_catalogue.h"

namespace postlens {
namespace {

// Largest accepted file size. Even a Zemax file with 500 surfaces is smaller than 1 MB.
constexpr std::uintmax_t largest_file_bytes = 64'000'000;

std::string ending_of(const std::filesystem::path& path) {
    return lower_case(path.extension().string());
}

// Converts UTF-16, which Zemax writes, to ASCII. Other characters occur only in names, and become question
// marks.
std::string decoded(std::string bytes) {
    const auto byte = [&bytes](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    if (bytes.size() >= 3 && byte(0) == 0xEF && byte(1) == 0xBB && byte(2) == 0xBF) return bytes.substr(3);
    if (bytes.size() < 2) return bytes;
    const bool marked_little = byte(0) == 0xFF && byte(1) == 0xFE;
    const bool marked_big = byte(0) == 0xFE && byte(1) == 0xFF;
    // Without a byte order mark, UTF-16 is recognised by zero bytes in the first two characters.
    const bool bare_little =
        bytes.size() >= 4 && byte(0) != 0 && byte(1) == 0 && byte(2) != 0 && byte(3) == 0;
    const bool bare_big = bytes.size() >= 4 && byte(0) == 0 && byte(1) != 0 && byte(2) == 0 && byte(3) != 0;
    const bool little = marked_little || bare_little;
    if (!little && !marked_big && !bare_big) return bytes;
    std::string out;
    out.reserve(bytes.size() / 2);
    for (std::size_t i = marked_little || marked_big ? 2 : 0; i + 1 < bytes.size(); i += 2) {
        const unsigned low = byte(i + (little ? 0 : 1)), high = byte(i + (little ? 1 : 0));
        out.push_back(high == 0 && low < 0x80 ? static_cast<char>(low) : '?');
    }
    return out;
}

// Replaces all characters of a lens file other than printable ASCII. The encoding of names in lens files is
// unknown.
void make_printable(std::string& text) {
    for (char& c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte > 0x7E) c = '?';
    }
}

bool has_surface_table(std::string_view text) {
    const auto lines = lines_of(text);
    return std::any_of(lines.begin(), lines.end(), [](const TextLine& line) {
        const std::size_t at = line.text.find_first_not_of(" \t");
        return at != std::string_view::npos && line.text.substr(at).starts_with("[[surface]]");
    });
}

}  // namespace

std::vector<TextLine> lines_of(std::string_view text) {
    std::vector<TextLine> out;
    int number = 1;
    for (std::size_t at = 0; at < text.size(); ++number) {
        const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
        out.push_back({number, text.substr(at, end - at)});
        at = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
    }
    return out;
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> out;
    constexpr std::string_view blanks = " \t\f\v";
    for (std::size_t at = 0; (at = line.find_first_not_of(blanks, at)) != std::string_view::npos;) {
        const char quote = line[at];
        if (quote == '"' || quote == '\'') {
            const std::size_t end = std::min(line.find(quote, at + 1), line.size());
            out.push_back(line.substr(at + 1, end - at - 1));
            at = std::min(end + 1, line.size());
        } else {
            const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
            out.push_back(line.substr(at, end - at));
            at = end;
        }
    }
    return out;
}

double number_in(const std::string& file, int line, std::string_view word, std::string_view what) {
    const auto value = parse_number(word);
    if (!value || !std::isfinite(*value)) {
        fail(ExitCode::invalid_input, "{}:{}: {} is not a finite number (got {}; expected a number)", file,
             line, what, excerpt(word));
    }
    return *value;
}

void check_surface_count(const std::string& file, int line, std::size_t count) {
    if (count < most_surfaces) return;
    fail(ExitCode::invalid_input, "{}:{}: too many surfaces (got more than {}; expected 1 to {})", file, line,
         most_surfaces, most_surfaces);
}

void check_object_medium(const std::string& file, const Surface& object) {
    if (object.glass.is_air()) return;
    fail(ExitCode::invalid_input, "{}:{}: the object is not in air (got {}; expected air before the lens)",
         file, object.line,
         object.glass.name().empty() ? fmt::format("index {:.6g}", object.glass.index(d_line_nm))
                                     : excerpt(object.glass.name()));
}

Glass glass_by_name(const std::string& file, int line, std::string_view name) {
    if (auto glass = find_glass(name)) return *std::move(glass);
    const auto names = glass_names();
    fail(ExitCode::invalid_input,
         "{}:{}: unknown glass (got {}; nearest known: '{}'; expected a known name, an index, or nd and Vd)",
         file, line, excerpt(name), nearest_word(name, names));
}

bool is_prescription(const std::filesystem::path& path) {
    const std::string ending = ending_of(path);
    if (ending == ".dat" || ending == ".zmx" || ending == ".seq") return true;
    if (ending != ".toml") return false;
    try {
        return has_surface_table(decoded(read_text_file(path, largest_file_bytes)));
    } catch (const Error&) {
        return false;
    }
}

Prescription read_prescription(const std::filesystem::path& path) {
    struct Format {
        std::string_view ending;
        Prescription (*parse)(const std::string&, const std::string&);
    };
    static constexpr std::array<Format, 4> formats{
        Format{".dat", parse_dat}, {".zmx", parse_zmx}, {".seq", parse_seq}, {".toml", parse_lens_toml}};
    const std::string file = path.string(), ending = ending_of(path);
    const auto* const format = std::find_if(formats.begin(), formats.end(),
                                            [&ending](const Format& f) { return f.ending == ending; });
    if (format == formats.end()) {
        (void)check_regular_file(path);
        fail(ExitCode::invalid_input,
             "{}: not a lens prescription (got the ending {}; expected .dat, .zmx, .seq or .toml)", file,
             excerpt(ending));
    }
    const std::string text = decoded(read_text_file(path, largest_file_bytes));
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
        fail(ExitCode::invalid_input, "{}: the file is empty (expected a lens prescription)", file);
    }
    Prescription lens = format->parse(text, file);
    make_printable(lens.name);
    make_printable(lens.source);
    clip_crossings(lens);
    check_prescription(lens);
    (void)first_order(lens);
    return lens;
}

}  // namespace postlens
