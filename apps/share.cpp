#include "apps/share.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>

#include "core/json_dump.h"
#include "core/percent.h"
#include "pictures/crop.h"
#include "scene/file_digest.h"
#include "scene/scene.h"
#include "tracer/recording/trace_share.h"

namespace postlens {
Share parse_share(std::string_view option, std::string_view text) {
    Share out;
    const std::size_t slash = text.find('/');
    const auto number = [](std::string_view word, int& to) {
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), to);
        return error == std::errc() && end == word.data() + word.size() && !word.empty();
    };
    if (slash == std::string_view::npos || !number(text.substr(0, slash), out.index) ||
        !number(text.substr(slash + 1), out.count) || !is_share(out.index, out.count)) {
        fail(ExitCode::wrong_arguments,
             "{}: out of range (got {}; expected I/N, I from 0 to N - 1, N from 1 to {})", option, text,
             most_shares);
    }
    return out;
}

Crop rows_of_share(const Share& share, const std::optional<Crop>& crop, int width, int height) {
    check_crop(crop, width, height);
    const Crop whole = crop.value_or(Crop{0, 0, width, height});
    const RowRange rows = rows_of_share(share, whole.y, whole.y + whole.height);
    return {whole.x, rows.begin, whole.width, rows.end - rows.begin};
}

namespace {

namespace fs = std::filesystem;

/// Caches the SHA-256 and modification time of files, because the frames of a film often share a scene.
class Digests {
  public:
    [[nodiscard]] std::optional<std::string> of(const std::string& path) {
        const std::lock_guard lock(mutex_);
        const auto at = known_.find(fs::absolute(path).string());
        if (at == known_.end()) return std::nullopt;
        const bool same = std::all_of(at->second.files.begin(), at->second.files.end(), [](const auto& file) {
            std::error_code none;
            return fs::last_write_time(file.first, none) == file.second && !none;
        });
        return same ? std::optional(at->second.digest) : std::nullopt;
    }

    void set(const std::string& path, std::vector<fs::path> files, const std::string& digest) {
        files.emplace_back(path);
        Known now{{}, digest};
        for (const fs::path& file : files) {
            std::error_code none;
            now.files.emplace_back(file, fs::last_write_time(file, none));
            // Caches a file's hash only if the file was last changed more than 2 s ago. A file that changes
            // twice within 2 s may keep its time stamp, so the cached hash could be wrong.
            constexpr std::chrono::seconds long_enough(2);
            if (none || fs::file_time_type::clock::now() - now.files.back().second < long_enough) return;
        }
        const std::lock_guard lock(mutex_);
        known_[fs::absolute(path).string()] = std::move(now);
    }

  private:
    struct Known {
        std::vector<std::pair<fs::path, fs::file_time_type>> files;
        std::string digest;
    };
    std::mutex mutex_;
    std::map<std::string, Known> known_;
};

Digests& digests() {
    static Digests all;
    return all;
}

/// Returns the SHA-256 of a file. For a scene, it includes the files to which the scene refers.
std::string digest_of(const std::string& path, bool scene) {
    if (fs::is_directory(path)) return "a folder";
    if (const auto known = digests().of(path)) return *known;
    if (scene) {
        const Scene read = read_scene(path);
        remember_digest(path, read);
        return read.sha256;
    }
    std::string digest = sha256_of_file(path);
    digests().set(path, {}, digest);
    return digest;
}

}  // namespace

nlohmann::ordered_json AskedFor::fingerprint(const std::function<std::string(const Input&)>& file_of) const {
    nlohmann::ordered_json out = {{"version", POSTLENS_VERSION}, {"command", command}};
    for (const auto& [name, values] : options) out[name] = values;
    for (const Input& input : inputs) {
        const std::string digest = digest_of(file_of ? file_of(input) : input.path, input.scene);
        out[input.option].push_back(input.before + "sha256:" + digest + input.after);
    }
    return out;
}

void remember_digest(const std::string& path, const Scene& scene) {
    digests().set(path, scene.referred, scene.sha256);
}

std::string mark_of(const SharedWork& work, const std::optional<Crop>& crop) {
    const auto list = [](const Crop& c) { return nlohmann::ordered_json{c.x, c.y, c.width, c.height}; };
    return json_dump(nlohmann::ordered_json{{"share", {work.share.index, work.share.count}},
                                            {"crop", crop ? list(*crop) : nlohmann::ordered_json()},
                                            {"made_by", work.asked_for()}});
}

std::optional<Share> share_of_mark(const std::string& mark) {
    const nlohmann::json json = nlohmann::json::parse(mark, nullptr, false);
    if (!json.is_object() || !json.contains("share")) return {};
    const nlohmann::json& share = json["share"];
    const auto whole = [](const nlohmann::json& n) { return n.is_number_integer(); };
    if (!share.is_array() || share.size() != 2 || !std::all_of(share.begin(), share.end(), whole)) return {};
    const auto index = share[0].get<std::int64_t>(), count = share[1].get<std::int64_t>();
    if (!is_share(index, count)) return {};
    return Share{static_cast<int>(index), static_cast<int>(count)};
}

std::string mark_of_items(const Share& share, const AskedFor& asked, const std::vector<std::string>& words) {
    std::vector<std::string> arguments;
    for (const std::string& word : words) arguments.push_back(percent_encoded(word));
    return json_dump(nlohmann::ordered_json{{"share", {share.index, share.count}},
                                            {"crop", nullptr},
                                            {"made_by", asked.fingerprint()},
                                            {"arguments", arguments}});
}

std::vector<std::string> words_of_mark(const nlohmann::ordered_json& mark) {
    std::vector<std::string> out;
    const nlohmann::ordered_json arguments = mark.value("arguments", nlohmann::ordered_json::array());
    for (const nlohmann::ordered_json& argument : arguments) {
        if (!argument.is_string()) return {};
        const std::string text = argument.get<std::string>();
        out.push_back(percent_decoded(text));
        if (percent_encoded(out.back()) != text) return {};
    }
    return out;
}

void take_share(std::optional<SharedWork>& work, std::optional<Crop>& crop, int width, int height) {
    if (!work) return;
    const Crop rows = rows_of_share(work->share, crop, width, height);
    work->mark = mark_of(*work, crop);
    crop = rows;
}

std::string first_difference(const nlohmann::ordered_json& got, const nlohmann::ordered_json& expected) {
    for (const auto& [name, value] : expected.items()) {
        if (!got.contains(name)) return fmt::format("{} (got nothing; expected {})", name, json_dump(value));
        if (got[name] != value)
            return fmt::format("{} (got {}; expected {})", name, json_dump(got[name]), json_dump(value));
    }
    for (const auto& [name, value] : got.items()) {
        if (!expected.contains(name))
            return fmt::format("{} (got {}; expected nothing)", name, json_dump(value));
    }
    return {};
}

}  // namespace postlens
