#include "focus/focus_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"
#include "focus/foreign/stack_field.h"
#include "focus/foreign_focus.h"
#include "pictures/aperture_file.h"
#include "pictures/foreign/cryptomatte.h"

namespace postlens {
namespace {

/// Objects that cover less than this fraction of a pixel are not written to the Cryptomatte. Renderers use a
/// similar limit.
constexpr float least_coverage = 1e-4F;
/// Smallest number of objects (ranks) that are stored per pixel in the format Cryptomatte, which lists the
/// objects that each pixel shows. It is large because blurred edges show many objects, and fixed because
/// separately computed parts of an image must have the same number.
constexpr std::size_t least_ranks = 8;

Image::Plane plane(std::string name, std::size_t pixels) {
    return {std::move(name), std::vector<float>(pixels, 0.0F)};
}

float alpha_of(const Image& image, std::size_t pixel) {
    return image.alpha.empty() ? 1.0F : image.alpha[pixel];
}

/// Returns the CoC diameter of each pixel, in px, negative in front of the focus, times the blur strength
/// `effect`.
Image::Plane coc_plane(const ForeignPicture& picture, const FocusGeometry& geometry,
                       const std::vector<float>& effect) {
    const auto width = static_cast<std::size_t>(picture.width);
    Image::Plane out = plane("CoC", width * static_cast<std::size_t>(picture.height));
    parallel_for(static_cast<std::size_t>(picture.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < picture.width; ++x) {
            const StackSample* seen = picture.stores(x, y) ? picture.seen_sample(x, y) : nullptr;
            if (seen == nullptr) continue;
            const std::size_t k = row * width + static_cast<std::size_t>(x);
            out.values[k] =
                (effect.empty() ? 1.0F : effect[k]) *
                static_cast<float>(geometry.coc_diameter_px(static_cast<double>(seen->spread_inverse_z())));
        }
    });
    return out;
}

/// Reduces the effect of the blur on the coverages of objects (fractions of a pixel that each object covers).
/// `effect` is the strength of the blur in each pixel, from 0 to 1. It is the weight of the blurred coverages
/// in a mixture with those of `pinhole`, which are not blurred.
void limit_to(const std::vector<float>& effect, const StackField& pinhole, StackField& blurred) {
    for (std::size_t k = 0; k < effect.size(); ++k) {
        for (ObjectShare& o : blurred.shares[k]) o.share *= effect[k];
        for (ObjectShare o : pinhole.shares[k]) {
            o.share *= 1 - effect[k];
            if (o.share > 0) blurred.shares[k].push_back(o);
        }
    }
}

void add_sides(const StackField& field, Image& image) {
    const std::size_t first = image.planes.size();
    for (const char* name : {"focus.before", "focus.in", "focus.behind"})
        image.planes.push_back(plane(name, field.shares.size()));
    for (std::size_t k = 0; k < field.shares.size(); ++k) {
        float sum = 0;
        for (const ObjectShare& o : field.shares[k]) sum += o.share;
        if (!(sum > 0)) continue;
        for (const ObjectShare& o : field.shares[k])
            image.planes[first + static_cast<std::size_t>(o.side + 1)].values[k] +=
                o.share * alpha_of(image, k) / sum;
    }
}

/// Adds the channels of a Cryptomatte (object masks) to `image`. Returns the number of pixels that show more
/// objects than the Cryptomatte stores per pixel.
std::size_t add_cryptomatte(const ForeignPicture& picture, const StackField& field, Image& image) {
    const Cryptomatte& source = *picture.channels.matte;
    std::vector<std::vector<std::pair<float, std::uint32_t>>> ranked(field.shares.size());
    std::size_t ranks = std::max(source.ranks.size(), least_ranks);
    for (std::size_t k = 0; k < ranked.size(); ++k) {
        std::map<std::uint32_t, float> coverages;
        float sum = 0;
        for (const ObjectShare& o : field.shares[k]) {
            coverages[o.id] += o.share;
            sum += o.share;
        }
        for (const auto& [id, share] : coverages) {
            const float coverage = sum > 0 ? share * alpha_of(image, k) / sum : 0;
            if (coverage >= least_coverage) ranked[k].emplace_back(coverage, id);
        }
        std::stable_sort(ranked[k].begin(), ranked[k].end(),
                         [](const auto& a, const auto& b) { return a.first > b.first; });
    }
    ranks += ranks % 2;
    for (std::size_t rank = 0; rank < ranks; ++rank) {
        const std::string layer = fmt::format("{}{:02}.", source.name, rank / 2);
        Image::Plane id = plane(layer + (rank % 2 == 0 ? "R" : "B"), ranked.size()),
                     coverage = plane(layer + (rank % 2 == 0 ? "G" : "A"), ranked.size());
        for (std::size_t k = 0; k < ranked.size(); ++k) {
            if (rank >= ranked[k].size()) continue;
            id.values[k] = std::bit_cast<float>(ranked[k][rank].second);
            coverage.values[k] = ranked[k][rank].first;
        }
        image.planes.push_back(std::move(id));
        image.planes.push_back(std::move(coverage));
    }
    // The Cryptomatte specification wants the first seven hex digits of the hash of the layer's name as
    // metadata key.
    const std::string key =
        fmt::format("cryptomatte/{:08x}", cryptomatte_id(source.name)).substr(0, 19) + "/";
    image.texts.emplace_back(key + "name", source.name);
    image.texts.emplace_back(key + "hash", "MurmurHash3_32");
    image.texts.emplace_back(key + "conversion", "uint32_to_float32");
    if (!source.manifest.empty()) image.texts.emplace_back(key + "manifest", source.manifest);
    return static_cast<std::size_t>(
        std::count_if(ranked.begin(), ranked.end(), [&](const auto& r) { return r.size() > ranks; }));
}

/// Returns the standard error of each pixel's colour, as the root mean square over the three channels. The
/// image is computed several times, from independent sets of lens points. The differences between these
/// images show the error.
std::vector<float> standard_error(const ForeignPicture& picture, const std::vector<Behind>& behind,
                                  StackFieldSettings s) {
    // Least number of lens points from which the noise of an image is estimated. The image is computed
    // several times, each time from another set of lens points, and the noise follows from the differences.
    // If all sets together had fewer points than this, the estimate would be unreliable.
    constexpr int least_views = 64;
    const int views = s.views;
    s.views = std::max(1, views / 2);
    const int sets = std::max(2, least_views / s.views);
    std::vector<double> sum, squares;
    for (int set = 1; set <= sets; ++set) {
        s.set = set;
        StackField field = stack_field(picture, behind, s);
        divide_by_covered(field);
        sum.resize(field.image.rgb.size());
        squares.resize(field.image.rgb.size());
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const auto value = static_cast<double>(field.image.rgb[i]);
            sum[i] += value;
            squares[i] += value * value;
        }
    }
    std::vector<float> out(sum.size() / 3);
    for (std::size_t k = 0; k < out.size(); ++k) {
        double variance = 0;  // variance of one set, summed over the channels
        for (std::size_t i = 3 * k; i < 3 * k + 3; ++i)
            variance += std::max(0.0, squares[i] - sum[i] * sum[i] / sets) / (sets - 1);
        out[k] = static_cast<float>(std::sqrt(variance / 3 * s.views / views));
    }
    return out;
}

/// Adds the channel "error" to `image`: the standard error of each pixel, which arises because the blur is a
/// mean over random lens points. `error` is its value for the full blur. Pixels that are blurred with less
/// strength, `effect` (0 to 1), have a smaller error by this factor.
void add_error(std::vector<float> error, const std::vector<float>& effect, Image& image) {
    for (std::size_t k = 0; k < effect.size(); ++k) error[k] *= effect[k];
    image.planes.push_back({"error", std::move(error)});
}

}  // namespace

double add_focus_passes(const ForeignPicture& picture, const FocusSettings& settings,
                        const FocusPasses& passes, Image& image, const std::vector<float>& effect) {
    if (!passes.any()) return 0;
    if (settings.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments,
             "--passes: not for a picture that the lens crops or magnifies (expected --framing keep)");
    }
    if (passes.cryptomatte && !picture.channels.matte) {
        const std::vector<std::string>& problems = picture.channels.problems;
        fail(ExitCode::wrong_arguments, "--passes: cryptomatte: {} (expected one in the file, or --ids-file)",
             problems.empty() ? "the picture has none" : problems.front());
    }
    const bool field = settings.method == FocusMethod::lightfield;
    if (passes.error && !field) {
        fail(ExitCode::wrong_arguments,
             "--passes: error: only views have one that can be measured (expected --method lightfield)");
    }
    const Film film{picture.camera.film_distance_mm, picture.pixel_pitch_mm()};
    const bool pinhole = settings.method == FocusMethod::pinhole || std::isinf(settings.lens.f_number);
    const FocusGeometry geometry =
        pinhole ? FocusGeometry{}
                : focus_geometry(settings.lens, settings.focus_distance_m, settings.framing, film);
    if (passes.coc) image.planes.push_back(coc_plane(picture, geometry, effect));
    if (!passes.by_views()) return 0;
    const Impulse impulse = pinhole ? Impulse() : impulse_in_px(settings.impulse, picture.pixel_aspect);
    if (!pinhole) check_has_points(impulse);
    const RasterWindow window{0, picture.width, 0, picture.height};
    StackFieldSettings s{geometry, read_aperture(impulse), window, window, settings.views};
    if (settings.crop) {
        const Crop& c = *settings.crop;
        s.drawn = {c.x, c.x + c.width, c.y, c.y + c.height};
    }
    const std::vector<Behind> behind =
        pinhole ? std::vector<Behind>()
                : behind_fill(picture, around_aperture(geometry, s.aperture), s.aberration_px());
    std::size_t beyond_ranks = 0;
    if (passes.sides || passes.cryptomatte) {
        s.shares = true;
        StackField seen = stack_field(picture, behind, s);
        if (!effect.empty() && !pinhole) {
            s.geometry = FocusGeometry{};
            limit_to(effect, stack_field(picture, {}, s), seen);
            s.geometry = geometry;
        }
        if (passes.sides) add_sides(seen, image);
        if (passes.cryptomatte) beyond_ranks = add_cryptomatte(picture, seen, image);
        s.shares = false;
    }
    if (passes.error) add_error(standard_error(picture, behind, s), effect, image);
    return static_cast<double>(beyond_ranks) / s.drawn.width() / s.drawn.height();
}

}  // namespace postlens
