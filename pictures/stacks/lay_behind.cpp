#include "pictures/stacks/lay_behind.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "core/error.h"
#include "core/memory.h"
#include "pictures/foreign/cryptomatte.h"

namespace postlens {
namespace {

/// Two inverse depths that differ by at most this relative amount count as equal. Rounding to half floats
/// causes such differences.
constexpr float same_depth = 1.0F / 1024;
/// The back image should show only what lies behind the front image. A sample of the back image counts as
/// nearer than the front image only if its distance is smaller by more than this fraction, because smaller
/// differences are noise in the depths.
constexpr float nearer_by = 1.0F / 20;

void check_same_view(const ForeignPicture& front, const ForeignPicture& back, const std::string& name) {
    if (front.width != back.width || front.height != back.height) {
        fail(ExitCode::invalid_input, "{}: cannot lie behind (got {}x{} px; expected {}x{} px, as in front)",
             name, back.width, back.height, front.width, front.height);
    }
    const double view = front.camera.film_width_mm / front.camera.film_distance_mm,
                 other = back.camera.film_width_mm / back.camera.film_distance_mm;
    constexpr double rounding = 1e-4;
    if (!(std::abs(front.pixel_aspect - back.pixel_aspect) <= rounding * front.pixel_aspect)) {
        fail(ExitCode::invalid_input,
             "{}: cannot lie behind (got a pixelAspectRatio of {:g}; expected {:g}, as in front)", name,
             back.pixel_aspect, front.pixel_aspect);
    }
    if (!(std::abs(view - other) <= rounding * view)) {
        fail(
            ExitCode::invalid_input,
            "{}: cannot lie behind (got a view {:.6g} wide at a distance of 1; expected {:.6g}, as in front)",
            name, other, view);
    }
}

/// If the samples in a pixel of the front image together transmit hardly any light, they hide all surfaces
/// behind the last sample. The function then returns the inverse depth of this last sample, in 1/m.
/// Otherwise, it returns infinity.
float last_opaque(std::span<const StackSample> stack) {
    float last = std::numeric_limits<float>::infinity();
    double left = 1;
    for (const StackSample& s : stack) {
        left *= 1 - static_cast<double>(s.alpha);
        if (left <= opaque_transmittance) last = s.inverse_z;
    }
    return last;
}

/// Returns true if light passes all samples of a stack.
bool is_open(std::span<const StackSample> stack) {
    return std::isinf(last_opaque(stack));
}

/// Returns true if a stack has a sample of the same surface as `s`: at the same depth and, if both have ids,
/// with the same id.
bool shows(std::span<const StackSample> stack, const StackSample& s) {
    const float near = s.inverse_z * (1 + same_depth), far = s.inverse_z * (1 - same_depth);
    const auto first = std::partition_point(stack.begin(), stack.end(),
                                            [&](const StackSample& a) { return a.inverse_z > near; });
    return std::any_of(
        first,
        std::partition_point(first, stack.end(), [&](const StackSample& a) { return a.inverse_z >= far; }),
        [&](const StackSample& a) { return a.id == s.id || a.id == 0 || s.id == 0; });
}

/// Returns the first row (or column) of the combined image, if the front image begins at the row `front` and
/// the back image at the row `back`. If `front` > 0, the rows before `front` are empty, and the back image
/// may fill some of them.
int begin_of_both(int front, int back) {
    return front > 0 ? std::min(front, back) : front;
}
/// Returns where the combined image ends (last row or column + 1), if the front image ends at `front` and the
/// back image at `back`. If `front` < `size`, the front image leaves the last rows empty, and the back image
/// may fill some of them.
int end_of_both(int front, int back, int size) {
    return front < size ? std::max(front, back) : front;
}

/// Joins the Cryptomatte manifests (lists of object names and ids) of the front image and of the back image.
/// If both manifests contain the same name, the joined manifest has its id in `front`. If `front` is empty,
/// returns `back`. If one of them cannot be read, returns `front`.
std::string both_manifests(const std::string& front, const std::string& back) {
    if (front.empty()) return back;
    const auto of_back = manifest_objects(back);
    if (!of_back || !manifest_objects(front)) return front;
    auto out = nlohmann::json::parse(front);
    for (const ManifestObject& o : *of_back) {
        if (!out.contains(o.name)) out[o.name] = fmt::format("{:08x}", o.id);
    }
    return out.dump();
}

}  // namespace

LaidBehind lay_behind(ForeignPicture& front, const ForeignPicture& back, const std::string& name) {
    check_same_view(front, back, name);
    ForeignPicture out;
    out.x_begin = begin_of_both(front.x_begin, back.x_begin);
    out.x_end = end_of_both(front.x_end, back.x_end, front.width);
    out.y_begin = begin_of_both(front.y_begin, back.y_begin);
    out.y_end = end_of_both(front.y_end, back.y_end, front.height);
    const auto pixels =
        static_cast<std::size_t>(out.x_end - out.x_begin) * static_cast<std::size_t>(out.y_end - out.y_begin);
    require_memory((front.samples.size() + back.samples.size()) * sizeof(StackSample) +
                       (pixels + 1) * (sizeof(std::uint64_t) + 1),
                   "images behind each other");
    out.samples.reserve(front.samples.size() + back.samples.size());
    out.offsets.reserve(pixels + 1);
    out.ends_in_nothing.reserve(pixels);
    LaidBehind found;
    std::size_t nearer = 0;
    // Returns whether it is known what an image shows at the pixel (x, y). A file need not store empty pixels
    // inside the image (0 <= x < width and 0 <= y < height). So if such a pixel is not stored, it is known to
    // be empty.
    const auto is_known = [](const ForeignPicture& p, int x, int y) {
        return p.stores(x, y) || (x >= 0 && x < p.width && y >= 0 && y < p.height);
    };
    const auto stack_of = [](const ForeignPicture& p, int x, int y) {
        return p.stores(x, y) ? p.stack(x, y) : std::span<const StackSample>();
    };
    for (int y = out.y_begin; y < out.y_end; ++y) {
        for (int x = out.x_begin; x < out.x_end; ++x) {
            const std::span<const StackSample> before = stack_of(front, x, y), more = stack_of(back, x, y);
            const float last = last_opaque(before);
            const auto begin = static_cast<std::ptrdiff_t>(out.samples.size());
            out.samples.insert(out.samples.end(), before.begin(), before.end());
            bool is_nearer = false;
            for (const StackSample& s : more) {
                if (shows(before, s)) continue;
                if (s.inverse_z < last * (1 - same_depth)) {
                    out.samples.push_back(s);
                    ++found.samples;
                } else {
                    is_nearer = is_nearer || s.inverse_z * (1 - nearer_by) > last;
                }
            }
            nearer += is_nearer ? 1 : 0;
            const bool adds = out.samples.size() > static_cast<std::size_t>(begin) + before.size();
            const bool was_nothing =
                !adds && front.stores(x, y) && front.is_nothing_behind(front.pixel_at(x, y));
            const bool is_nothing = std::isfinite(last) && is_known(back, x, y) && is_open(more);
            out.ends_in_nothing.push_back(was_nothing || is_nothing ? 1 : 0);
            std::inplace_merge(
                out.samples.begin() + begin,
                out.samples.begin() + begin + static_cast<std::ptrdiff_t>(before.size()), out.samples.end(),
                [](const StackSample& a, const StackSample& b) { return a.inverse_z > b.inverse_z; });
            out.offsets.push_back(out.samples.size());
        }
    }
    if (back.offsets.size() > 1)
        found.nearer_share = static_cast<double>(nearer) / static_cast<double>(back.offsets.size() - 1);
    if (front.channels.matte && back.channels.matte) {
        std::string& manifest = front.channels.matte->manifest;
        manifest = both_manifests(manifest, back.channels.matte->manifest);
    }
    front.x_begin = out.x_begin;
    front.x_end = out.x_end;
    front.y_begin = out.y_begin;
    front.y_end = out.y_end;
    front.samples = std::move(out.samples);
    front.offsets = std::move(out.offsets);
    front.ends_in_nothing = std::move(out.ends_in_nothing);
    return found;
}

}  // namespace postlens
