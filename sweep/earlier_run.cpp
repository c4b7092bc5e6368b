#include "sweep/earlier_run.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <fstream>
#include <utility>

#include "core/checksum.h"
#include "core/files/share_table.h"
#include "core/files/text_file.h"
#include "lens/impulse.h"
#include "planner/auto_picture.h"
#include "sweep/picture_maker.h"

namespace postlens {
namespace {

/// XXH3 checksum of a file's bytes. Empty if it cannot be read.
std::optional<std::uint64_t> file_checksum(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) return std::nullopt;
    Checksum sum;
    std::vector<char> buffer(1U << 16U);
    while (in) {
        in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        sum.add(buffer.data(), static_cast<std::size_t>(in.gcount()));
    }
    if (in.bad()) return std::nullopt;
    return sum.value();
}

}  // namespace

std::string file_checksum_text(const std::filesystem::path& path) {
    const std::optional<std::uint64_t> checksum = file_checksum(path);
    return checksum ? checksum_text(*checksum) : "";
}

SweepKeys::SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
                     FocusMethod method, const std::vector<glm::dvec2>& at) {
    const PictureSettings& p = settings.picture;
    common_ =
        fmt::format("1 {} {} {} {} {} {} {} {} {:x} {}", file_checksum_text(frame), method_name(method),
                    static_cast<int>(p.framing), static_cast<int>(p.spacing), static_cast<int>(p.depth_model),
                    p.depths.value_or(0), p.views.value_or(0), settings.coc_limit_px, p.curve.fingerprint(),
                    p.scene != nullptr ? p.scene->sha256 : "");
    if (exposure_stops != 0) common_ += fmt::format(" exposure {}", exposure_stops);
    if (p.scene != nullptr && p.scene->lumens_per_watt)
        common_ += fmt::format(" lumens {}", *p.scene->lumens_per_watt);
    if (p.scene != nullptr && p.scene->metres_per_unit != 1)
        common_ += fmt::format(" metres {}", p.scene->metres_per_unit);
    predicted_ = p.predict;
    if (method == FocusMethod::automatic)
        common_ += fmt::format(" {}", p.target_db.value_or(default_target_db));
    for (const glm::dvec2& point : at) common_ += fmt::format(" {},{}", point.x, point.y);
    for (const auto& path : settings.depends_on) common_.append(" ").append(file_checksum_text(path));
}

std::string SweepKeys::key(const SweepSetting& s, bool predicted) const {
    std::string key = fmt::format("{} {} {} {}", common_, s.f_number, s.focal_length_mm, s.focus_m);
    if (s.shutter) key += fmt::format(" {}:{}", s.shutter->open_s, s.shutter->close_s);
    const Impulse& i = s.impulse;
    key += fmt::format(" {} {} {} {}", impulse_text(i), i.squeeze, i.cats_eye, i.spherical);
    if (!i.file.empty()) key.append(" ").append(file_checksum_text(i.file));
    if (predicted) key += " predicted";
    return checksum_text(checksum_of(key.data(), key.size()));
}

std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                  const std::filesystem::path& folder,
                                                  const std::filesystem::path& json) {
    constexpr std::uintmax_t largest_bytes = 64'000'000;
    if (!settings.resume) return {};
    std::vector<std::filesystem::path> tables;
    if (!settings.share) tables = share_tables(folder, "sweep");
    if (std::filesystem::exists(json)) tables.push_back(json);
    std::multimap<std::string, SweepRow> out;
    for (const std::filesystem::path& table : tables) {
        for (auto& [name, row] : rows_of_json(read_text_file(table, largest_bytes), table.string()))
            out.emplace(name, std::move(row));
    }
    return out;
}

}  // namespace postlens
