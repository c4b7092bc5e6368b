#include "sweep/sweep_checks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "focus/light_field/lens_views.h"
#include "focus/responses/depth_levels.h"
#include "lens/focus_geometry.h"
#include "lens/impulse.h"
#include "planner/predicted_error.h"

namespace postlens {
namespace {

void check_format(const std::string& format) {
    for (const char* known : {"exr", "png", "tif", "jpg"}) {
        if (format == known) return;
    }
    fail(ExitCode::wrong_arguments, "--format: unknown (got {}; expected exr, png, tif or jpg)", format);
}

void check_range(const char* option, const std::optional<int>& value, int least, int most) {
    if (!value || (*value >= least && *value <= most)) return;
    fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected {} to {})", option, *value, least,
         most);
}

}  // namespace

std::vector<glm::dvec2> sweep_points(const SweepSettings& s, const SampleHeader& h) {
    std::vector<glm::dvec2> out = s.at;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const glm::dvec2& at = out[i];
        // Each point of --at gets a column in sweep.csv, named after it. So no point may occur twice.
        if (std::find(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(i), at) !=
            out.begin() + static_cast<std::ptrdiff_t>(i)) {
            fail(ExitCode::wrong_arguments,
                 "--at: twice in the list (got {:.6g},{:.6g}; expected every point once)", at.x, at.y);
        }
        if (at.x < 0 || at.y < 0 || at.x >= h.width || at.y >= h.height) {
            fail(ExitCode::wrong_arguments,
                 "--at: outside the picture (got {:.6g},{:.6g}; expected 0,0 to "
                 "less than {},{})",
                 at.x, at.y, h.width, h.height);
        }
    }
    if (!out.empty()) return out;
    for (const double y : {1.0, 3.0, 5.0}) {
        for (const double x : {1.0, 3.0, 5.0}) out.emplace_back(x / 6 * h.width, y / 6 * h.height);
    }
    return out;
}

std::vector<std::string> sweep_file_names(const SweepSettings& s, const SweepGrid& grid) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < grid.pictures.size(); ++i) {
        std::string name = grid.pictures[i].name;
        if (s.frames) {
            const std::optional<std::string> numbered = numbered_name(*s.frames, i + 1);
            if (numbered && numbered->find('/') != std::string::npos) {
                fail(ExitCode::wrong_arguments,
                     "--frames: names a folder (got {}; expected a name, as all pictures are in DIR)",
                     *s.frames);
            }
            if (!numbered) {
                fail(ExitCode::wrong_arguments,
                     "--frames: not a name with a number (got {}; expected e.g. pull.%04d)", *s.frames);
            }
            name = *numbered;
        }
        out.push_back(name + "." + s.format);
    }
    return out;
}

void check_sweep_limits(const SweepSettings& settings) {
    if (!(settings.coc_limit_px > 0) || !std::isfinite(settings.coc_limit_px)) {
        fail(ExitCode::wrong_arguments, "--coc-limit: out of range (got {}; expected px, more than 0)",
             settings.coc_limit_px);
    }
    check_format(settings.format);
}

void check_sweep_lenses(const SweepSettings& settings, const SweepGrid& grid, const SampleHeader& h,
                        FocusMethod method) {
    const PictureSettings& p = settings.picture;
    check_range("--depths", p.depths, 2, DepthLevels::most_depths);
    check_range("--views", p.views, 1, most_lens_views);
    const bool by_views = method == FocusMethod::lightfield || method == FocusMethod::hybrid ||
                          method == FocusMethod::automatic;
    for (const SweepSetting& s : grid.pictures) {
        if (p.predict) check_predictable(h, {.framing = p.framing, .impulse = s.impulse});
        if (std::isinf(s.f_number) || method == FocusMethod::pinhole) continue;
        if (by_views) check_has_points(s.impulse);
        if (h.projection == Projection::orthographic) {
            fail(ExitCode::wrong_arguments,
                 "--f-number: out of range for an orthographic file, which no lens can have taken (got "
                 "{}; "
                 "expected inf)",
                 s.f_number);
        }
        if (s.impulse.kind == ImpulseKind::lens) continue;
        static_cast<void>(focus_geometry({.focal_length_mm = s.focal_length_mm, .f_number = s.f_number},
                                         s.focus_m, settings.picture.framing,
                                         {h.film_distance_mm, h.pixel_pitch_mm}));
    }
}

std::vector<std::filesystem::path> sweep_inputs(const std::filesystem::path& frame,
                                                const SweepSettings& settings) {
    std::vector<std::filesystem::path> read{frame};
    read.insert(read.end(), settings.depends_on.begin(), settings.depends_on.end());
    if (const Scene* scene = settings.picture.scene; scene != nullptr)
        read.insert(read.end(), scene->referred.begin(), scene->referred.end());
    for (const Impulse& i : settings.axes.impulses) {
        if (!i.file.empty()) read.push_back(i.file);
    }
    return read;
}

}  // namespace postlens
