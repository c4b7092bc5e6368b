#include "pictures/foreign/foreign_depths.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/counted.h"
#include "core/error.h"
#include "core/threads.h"
#include "pictures/foreign/filtered_depth.h"

namespace postlens {
namespace {

/// Returns the factor that converts a pixel's inverse depth in the file to 1 / z, in 1/m, where z is the
/// depth along the optical axis. The file may use another unit, or measure the depth along the ray through
/// the pixel.
float depth_scale(const ForeignPicture& picture, std::size_t pixel) {
    const auto width = static_cast<std::size_t>(picture.x_end - picture.x_begin);
    const ForeignCamera& camera = picture.camera;
    if (camera.depth_along != DepthAlong::ray) return static_cast<float>(1 / camera.metres_per_unit);
    const double pitch = picture.pixel_pitch_mm() / camera.film_distance_mm;
    const std::size_t column = pixel % width, row = pixel / width;
    const double u = (picture.x_begin + static_cast<double>(column) + 0.5 - picture.width / 2.0) * pitch *
                         picture.pixel_aspect +
                     camera.centre_x,
                 v = (picture.y_begin + static_cast<double>(row) + 0.5 - picture.height / 2.0) * pitch +
                     camera.centre_y;
    return static_cast<float>(std::sqrt(1 + u * u + v * v) / camera.metres_per_unit);
}

/// Finds pixels at the rim of an opaque object in front of the sky. The alpha of such a pixel is the fraction
/// that the object covers, because the sky has the alpha 0. Returns the fractions and depths of object and
/// sky for the index of each such pixel.
std::map<std::size_t, std::array<SurfaceShare, 2>> rims_before_sky(const ForeignPicture& picture,
                                                                   std::size_t width) {
    constexpr int reach = 2;  // px, the radius of the filter
    constexpr float same = 0.05F, transparent = 0.02F, opaque = 0.998F;
    std::map<std::size_t, std::array<SurfaceShare, 2>> out;
    const auto at = [&](int x, int y) -> const StackSample* {
        if (!picture.stores(x, y)) return nullptr;
        const auto stack = picture.stack(x, y);
        return stack.empty() ? nullptr : stack.data();
    };
    const auto is_rim = [](const StackSample* s) {
        return s != nullptr && s->inverse_z != 0 && s->alpha > transparent && s->alpha < opaque;
    };
    const auto height = static_cast<std::size_t>(picture.y_end - picture.y_begin);
    std::vector<std::vector<std::size_t>> of_rows(height);
    parallel_for(height, [&](std::size_t row) {
        for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
            const auto stack = picture.stack_of(i);
            if (!stack.empty() && is_rim(stack.data())) of_rows[row].push_back(i);
        }
    });
    std::vector<std::size_t> rims;
    for (const std::vector<std::size_t>& row : of_rows) rims.insert(rims.end(), row.begin(), row.end());
    for (const std::size_t i : rims) {
        const int x = picture.x_begin + static_cast<int>(i % width),
                  y = picture.y_begin + static_cast<int>(i / width);
        const StackSample* rim = at(x, y);
        bool has_object = false;
        const StackSample* sky = nullptr;
        for (int v = y - reach; v <= y + reach; ++v) {
            for (int u = x - reach; u <= x + reach; ++u) {
                const StackSample* s = at(u, v);
                if (s == nullptr) continue;
                has_object = has_object || (s->alpha >= opaque &&
                                            std::abs(s->inverse_z - rim->inverse_z) <= same * rim->inverse_z);
                if (s->alpha <= transparent && s->inverse_z < rim->inverse_z * (1 - same)) sky = s;
            }
        }
        if (has_object && sky != nullptr)
            out[i] = {{{0, rim->alpha, rim->inverse_z}, {0, 1 - rim->alpha, sky->inverse_z}}};
    }
    return out;
}

}  // namespace

void ForeignDepths::take(const ForeignPart& part, std::vector<float>& depths,
                         const std::vector<float>& covered, ForeignPicture& picture) {
    const auto width = static_cast<std::size_t>(part.width());
    const FilteredDepths filtered = mend_filtered_depths(depths, covered, width, !picture.channels.matte);
    const std::size_t pixels = picture.offsets.size() - 1;
    const auto place = [&](std::size_t i) {
        return std::pair(part.data.x_min + static_cast<int>(i % width),
                         part.data.y_min + static_cast<int>(i / width));
    };
    std::vector<Seen> seen(static_cast<std::size_t>(part.height()));
    parallel_for(seen.size(), [&](std::size_t row) {
        for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
            const auto [x, y] = place(i);
            for (std::uint64_t k = picture.offsets[i]; k < picture.offsets[i + 1]; ++k)
                picture.samples[k].inverse_z = inverse(depths[i], x, y, seen[row]);
        }
    });
    for (const Seen& of_row : seen) seen_.add(of_row);
    const auto share = [&](std::size_t count) {
        return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(pixels, 1));
    };
    if (filtered.divided > 0) {
        picture.repairs.push_back(
            {"repaired",
             fmt::format("{} multiplied by alpha: divided by it", counted(filtered.divided, "depth")),
             share(filtered.divided)});
    }
    if (filtered.taken_over > 0) {
        picture.repairs.push_back(
            {"repaired",
             fmt::format("{} averaged with nothing, at rims: the depth of neighbours instead",
                         counted(filtered.taken_over, "depth")),
             share(filtered.taken_over)});
    }
    std::map<std::size_t, std::array<SurfaceShare, 2>> mixed;
    if (!picture.channels.matte) mixed = rims_before_sky(picture, width);
    if (!filtered.mixed.empty()) {
        picture.repairs.push_back(
            {"repaired",
             fmt::format("{} averaged of near and far: each part of the pixel gets its own",
                         counted(filtered.mixed.size(), "depth")),
             share(filtered.mixed.size())});
    }
    for (const MixedDepth& m : filtered.mixed) {
        const auto [x, y] = place(m.pixel);
        mixed[m.pixel] = {
            {{0, m.near_share, inverse(m.near, x, y)}, {0, 1 - m.near_share, inverse(m.far, x, y)}}};
    }
    for (auto& [pixel, shares] : mixed) {
        if (shares[0].share < 0.5F) std::swap(shares[0], shares[1]);
        picture.mixed.push_back({pixel, picture.shares.size(), 2});
        picture.shares.insert(picture.shares.end(), shares.begin(), shares.end());
    }
}

void ForeignDepths::finish(const ForeignFile& file, const ForeignPart& part, ForeignPicture& picture) const {
    if (seen_.negative > 0 && seen_.positive > 0) {
        fail(ExitCode::invalid_input,
             "{}: channel {} at pixel {},{} is unusable (got {}; expected a depth of 0 or more, or none "
             "such)",
             file.name(), picture.channels.z, seen_.first_negative.x, seen_.first_negative.y,
             seen_.first_negative.z);
    }
    if (seen_.negative > 0) {
        picture.repairs.push_back(
            {"assumed", "all depths are negative: their size is taken as the distance", 1});
    }
    warn_of_encoding(picture);
    const auto width = static_cast<std::size_t>(part.width());
    const auto scaled = [](float inverse_z, float scale) {
        const float out = inverse_z * scale;
        return std::isfinite(out) ? out : std::numeric_limits<float>::max();
    };
    std::vector<Seen> seen(static_cast<std::size_t>(part.height()));
    parallel_for(seen.size(), [&](std::size_t row) {
        for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
            const float scale = depth_scale(picture, i);
            const auto stack = std::span(picture.samples)
                                   .subspan(picture.offsets[i], picture.offsets[i + 1] - picture.offsets[i]);
            for (StackSample& s : stack) s.inverse_z = scaled(s.inverse_z, scale);
            if (stack.size() < 2) continue;  // std::stable_sort would allocate memory
            std::stable_sort(stack.begin(), stack.end(), [](const StackSample& a, const StackSample& b) {
                return a.inverse_z > b.inverse_z;
            });
        }
    });
    for (const MixedPixel& m : picture.mixed) {
        for (std::size_t k = m.first; k < m.first + m.count; ++k) {
            auto& inverse_z = picture.shares[k].inverse_z;
            if (inverse_z) inverse_z = scaled(*inverse_z, depth_scale(picture, m.pixel));
        }
    }
}

void ForeignDepths::warn_of_encoding(ForeignPicture& picture) const {
    constexpr float rounding = 1e-3F;
    if (encoding_ && encoding_->kind == DepthEncoding::Kind::normalized &&
        seen_.greatest_value > 1 + rounding) {
        picture.repairs.push_back(
            {"assumed",
             fmt::format(
                 "normalized depths are up to {:.6g}, not 1: they are farther than the end of the range "
                 "that --depth-encoding states",
                 seen_.greatest_value),
             1});
    }
    if (encoding_ || seen_.negative + seen_.positive == 0 || seen_.farthest > 1) return;
    picture.repairs.push_back(
        {"assumed",
         fmt::format("no depth is beyond {:.6g}: they may be inverse or normalized, and are taken as "
                     "distances (--depth-encoding)",
                     seen_.farthest),
         1});
}

}  // namespace postlens
