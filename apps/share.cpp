#include "apps/share.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "records/crop.h"
#include "tracer/file_digest.h"

namespace postlens {

Share parse_share(std::string_view option, std::string_view text) {
    constexpr int most = 100000;
    Share out;
    const std::size_t slash = text.find('/');
    const auto number = [](std::string_view word, int& to) {
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), to);
        return error == std::errc() && end == word.data() + word.size() && !word.empty();
    };
    if (slash == std::string_view::npos || !number(text.substr(0, slash), out.index) ||
        !number(text.substr(slash + 1), out.count) || out.count < 1 || out.count > most || out.index < 0 ||
        out.index >= out.count) {
        fail(ExitCode::wrong_arguments,
             "{}: out of range (got {}; expected I/N, I from 0 to N - 1, N from 1 to {})", option, text,
             most);
    }
    return out;
}

Crop rows_of_share(const Share& share, const std::optional<Crop>& crop, int width, int height) {
    check_crop(crop, width, height);
    const Crop whole = crop.value_or(Crop{0, 0, width, height});
    if (share.count > whole.height) {
        fail(ExitCode::wrong_arguments, "--share: more shares than rows (got {}; expected {} or less)",
             share.count, whole.height);
    }
    const auto row = [&](int i) {
        return static_cast<int>(static_cast<std::int64_t>(whole.height) * i / share.count);
    };
    const int begin = row(share.index), end = row(share.index + 1);
    return {whole.x, whole.y + begin, whole.width, end - begin};
}

nlohmann::ordered_json AskedFor::fingerprint() const {
    nlohmann::ordered_json out = {{"version", POSTLENS_VERSION}, {"command", command}};
    for (const auto& [name, values] : options) out[name] = values;
    for (const auto& [name, path] : inputs) {
        const std::string digest = std::filesystem::is_directory(path) ? "a folder" : sha256_of_file(path);
        out[name].push_back("sha256:" + digest);
    }
    return out;
}

std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop) {
    const auto list = [](const Crop& c) { return nlohmann::ordered_json{c.x, c.y, c.width, c.height}; };
    return nlohmann::ordered_json{{"share", {work.share.index, work.share.count}},
                                  {"crop", crop ? list(*crop) : nlohmann::ordered_json()},
                                  {"made_by", work.asked_for()}}
        .dump();
}

void take_share(std::optional<SharedWork>& work, std::optional<Crop>& crop, int width, int height) {
    if (!work) return;
    const Crop rows = rows_of_share(work->share, crop, width, height);
    work->mark = mark_of(*work, crop);
    crop = rows;
}

std::string first_difference(const nlohmann::ordered_json& got, const nlohmann::ordered_json& expected) {
    for (const auto& [name, value] : expected.items()) {
        if (!got.contains(name)) return fmt::format("{} (got nothing; expected {})", name, value.dump());
        if (got[name] != value)
            return fmt::format("{} (got {}; expected {})", name, got[name].dump(), value.dump());
    }
    for (const auto& [name, value] : got.items()) {
        if (!expected.contains(name)) return fmt::format("{} (got {}; expected nothing)", name, value.dump());
    }
    return {};
}

}  // namespace postlens
