#include <cmath>

#include "apps/command.h"
#include "records/pixel_samples.h"

namespace postlens {
namespace {

// The longest and the shortest diameter of an elliptical circle of confusion, in px.
// Let g be the film distance / pixel pitch, s the focus distance in m, and I the identity matrix. W is the
// 2x2 matrix, in 1/m, that the file stores for the surface: I / depth if it is seen directly. Let A = g (I /
// s - W). When the lens point moves by q metres, the image of the surface moves by A q px. The diameters are
// the singular values of A, times the diameter of the aperture in m.
struct CocAxes {
    double longer_px, shorter_px;
};
CocAxes coc_axes(const FocusGeometry& lens, const Mat2& w) {
    const double k = 2 * lens.aperture_radius_m * lens.gain_px, f = lens.inverse_focus_per_m;
    const double a = k * (f - static_cast<double>(w.xx)), b = -k * static_cast<double>(w.xy);
    const double c = -k * static_cast<double>(w.yx), d = k * (f - static_cast<double>(w.yy));
    const double s = std::hypot(a + d, b - c), t = std::hypot(a - d, b + c);
    return {(s + t) / 2, std::abs(s - t) / 2};
}

nlohmann::ordered_json node_json(const Record& r, const std::string& name,
                                 const std::optional<FocusGeometry>& lens) {
    nlohmann::ordered_json node = {{"path", r.path.text()},
                                   {"depth", r.path.depth()},
                                   {"id", r.id},
                                   {"name", name},
                                   {"z_m", json_number(static_cast<double>(r.z))},
                                   {"rgb", {r.r, r.g, r.b}},
                                   {"layer", r.layer},
                                   {"w_per_m", {{r.w.xx, r.w.xy}, {r.w.yx, r.w.yy}}},
                                   {"w_bend_per_m2", json_number(static_cast<double>(r.w_bend))},
                                   {"mark", r.mark}};
    if (lens) {
        const CocAxes coc = coc_axes(*lens, r.w);
        node["coc_px"] = {coc.longer_px, coc.shorter_px};
    }
    return node;
}

std::string node_text(const Record& r, const std::string& name, const std::optional<FocusGeometry>& lens) {
    std::string line = fmt::format("  {:{}}{:<8} id {:<5} {:<20} z' {:<10.5g} rgb {:.4g} {:.4g} {:.4g}", "",
                                   2 * r.path.depth(), r.path.text(), r.id, name, r.z, r.r, r.g, r.b);
    const bool isotropic = r.w.xx == r.w.yy && r.w.xy == 0 && r.w.yx == 0;
    line += isotropic ? fmt::format("  W {:.5g}", r.w.xx)
                      : fmt::format("  W {:.5g} {:.5g} / {:.5g} {:.5g}", r.w.xx, r.w.xy, r.w.yx, r.w.yy);
    if ((r.mark & RecordMark::fine_texture) != 0) line += "  fine texture";
    if ((r.mark & RecordMark::gap) != 0) line += "  gap";
    if (r.w_bend != 0) line += fmt::format("  bend {:.4g}", r.w_bend);
    if (lens) {
        const CocAxes coc = coc_axes(*lens, r.w);
        line += fmt::format("  CoC {:.2f} x {:.2f} px", coc.longer_px, coc.shorter_px);
    }
    if (r.layer > 0) line += fmt::format("  hidden layer {}", r.layer);
    return line + "\n";
}

// Returns the lens that the options and the file define, or an empty value if they define no lens.
std::optional<FocusGeometry> lens_of(const LensOptions& options, const SampleFileReader& file) {
    const SampleHeader& h = file.header();
    if (h.projection == Projection::orthographic) return std::nullopt;
    const bool f_number = options.f_number || h.f_number,
               focus = options.focus_m || options.focus_at || h.focus_m;
    if (!f_number || !focus) return std::nullopt;
    const ResolvedLens lens = resolve_lens(options, file);
    return focus_geometry(lens.lens, lens.focus_m, options.framing, {h.film_distance_mm, h.pixel_pitch_mm});
}

}  // namespace

CommandResult run_records(const RecordsOptions& options) {
    const SampleFileReader file(options.input, damage_rule(options.salvage), 0.0);  // 0 stops: radiance
    const SampleHeader& h = file.header();
    const auto lens = lens_of(options.lens, file);
    const double limit = 1e6;  // in px; larger than any raster, but representable as an int
    if (std::abs(options.at.first) > limit || std::abs(options.at.second) > limit) {
        fail(ExitCode::wrong_arguments, "--at: outside the picture (got {},{})", options.at.first,
             options.at.second);
    }
    const int x = static_cast<int>(std::floor(options.at.first)),
              y = static_cast<int>(std::floor(options.at.second));
    if (options.key < 0 || static_cast<std::size_t>(options.key) >= file.instants()) {
        fail(ExitCode::wrong_arguments, "--key: the file has no such instant (got {}; expected 0 to {})",
             options.key, file.instants() - 1);
    }
    const auto instant = static_cast<std::size_t>(options.key);
    CommandResult out;
    warn_of_missing_rows(file, out.warnings);
    out.json = {{"x", x},
                {"y", y},
                {"time_s", file.instant_s(instant)},
                {"samples", nlohmann::ordered_json::array()}};
    out.text = fmt::format("pixel {},{}\n", x, y);
    for (const PixelSample& s : pixel_samples(file, x, y, instant)) {
        nlohmann::ordered_json sample = {
            {"x", s.x}, {"y", s.y}, {"weight", s.weight}, {"nodes", nlohmann::ordered_json::array()}};
        out.text += fmt::format("sample {},{}  weight {:.6g}\n", s.x, s.y, s.weight);
        for (const Record& r : s.nodes) {
            const auto found = h.object_names.find(r.id);
            const std::string name = found != h.object_names.end() ? found->second
                                     : r.id == 0                   ? "(nothing)"
                                                                   : "";
            sample["nodes"].push_back(node_json(r, name, lens));
            out.text += node_text(r, name, lens);
        }
        out.json["samples"].push_back(std::move(sample));
    }
    return out;
}

}  // namespace postlens
