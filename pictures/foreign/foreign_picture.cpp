#include "pictures/foreign/foreign_picture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"
#include "pictures/foreign/deep_volumes.h"
#include "pictures/foreign/filtered_depth.h"
#include "pictures/foreign/foreign_planes.h"

namespace postlens {
namespace {

constexpr float nothing_z = 1e9F;  ///< renderers write 1e9, 1e10 or infinity where a ray hits nothing
/// Target ratio of the far to the near depth of a volume's slice, and largest number of slices of a volume.
constexpr double slice_ratio = 1.02;
constexpr int most_slices = 32;
/// Smallest share of a pixel for which a surface is kept.
constexpr float least_share = 0.01F;

/// Converts the values of the file to stacks of samples.
class Reader {
  public:
    Reader(const std::filesystem::path& path, const ForeignChoice& choice, const ForeignCameraChoice& camera)
        : file_(open_foreign_file(path, choice)), encoding_(choice.depth_encoding) {
        out_.channels = find_foreign_channels(file_, choice);
        part_ = &file_.parts()[out_.channels.part];
        out_.deep = part_->deep;
        out_.width = part_->display.x_max - part_->display.x_min + 1;
        out_.height = part_->display.y_max - part_->display.y_min + 1;
        out_.x_begin = part_->data.x_min - part_->display.x_min;
        out_.y_begin = part_->data.y_min - part_->display.y_min;
        out_.x_end = out_.x_begin + part_->width();
        out_.y_end = out_.y_begin + part_->height();
        // One raster holds both the display window and the stored pixels, so its size is limited.
        const auto columns = static_cast<std::uint64_t>(std::max(out_.width, out_.x_end) -
                                                        std::min(0, out_.x_begin)),
                   rows = static_cast<std::uint64_t>(std::max(out_.height, out_.y_end) -
                                                     std::min(0, out_.y_begin));
        constexpr std::uint64_t unquestioned = std::uint64_t{1} << 25U;
        const std::uint64_t windows =
            2 * (static_cast<std::uint64_t>(out_.width) * static_cast<std::uint64_t>(out_.height) + pixels());
        if (columns * rows > std::max(unquestioned, windows)) {
            fail(ExitCode::invalid_input,
                 "{}: windows are out of bounds (got {}x{} px around dataWindow and displayWindow; expected "
                 "them close "
                 "to each other)",
                 file_.name(), columns, rows);
        }
        take_camera(camera);
        const ForeignChannels& c = out_.channels;
        whole_ids_ = !c.id.empty() && file_.kind(c.id_part, c.id) == ChannelKind::whole;
        for (const std::string& problem : c.problems) out_.repairs.push_back({"ids", problem, 0});
        for (const std::string& text : c.assumed) out_.repairs.push_back({"assumed", text, 0});
        const auto aspect = file_.number(c.part, "pixelAspectRatio");
        if (aspect && std::abs(*aspect - 1) > 1e-4) {
            out_.repairs.push_back(
                {"assumed",
                 fmt::format("pixels are {:g} times as wide as tall in the file: taken as square", *aspect),
                 0});
        }
    }

    ForeignPicture read() {
        if (part_->deep) {
            read_deep();
        } else {
            read_flat();
        }
        finish_depths();
        mend_colours();
        report();
        return std::move(out_);
    }

  private:
    [[nodiscard]] std::size_t pixels() const {
        return static_cast<std::size_t>(part_->width()) * static_cast<std::size_t>(part_->height());
    }
    void make_room(std::size_t more) {
        if (out_.samples.capacity() - out_.samples.size() >= more) return;
        const std::size_t next = std::max(out_.samples.size() + more, out_.samples.capacity() * 3 / 2);
        require_memory(next * sizeof(StackSample), "the picture's samples");
        out_.samples.reserve(next);
    }

    /// The camera, and the frame within the display window.
    void take_camera(ForeignCameraChoice choice) {
        const int margin = choice.overscan_px;
        if (margin < 0 || 2 * margin >= std::min(out_.width, out_.height)) {
            fail(ExitCode::wrong_arguments,
                 "--overscan: leaves no frame (got {}; expected 0 to {} for the {}x{} px of {})", margin,
                 (std::min(out_.width, out_.height) - 1) / 2, out_.width, out_.height, file_.name());
        }
        const double of_frame = static_cast<double>(out_.width - 2 * margin) / out_.width;
        // The camera in the file describes the whole display window, so a film width of the frame is
        // converted to one of the window.
        if (choice.film_width_mm) *choice.film_width_mm /= of_frame;
        out_.camera = foreign_camera(file_, out_.channels.part, choice);
        out_.camera.film_width_mm *= of_frame;
        out_.width -= 2 * margin;
        out_.height -= 2 * margin;
        out_.x_begin -= margin;
        out_.x_end -= margin;
        out_.y_begin -= margin;
        out_.y_end -= margin;
    }

    struct MatteEntry {
        std::size_t pixel;
        SurfaceShare share;
    };

    /// Shares of all pixels, with the values of the file, sorted by pixel.
    std::vector<MatteEntry> matte_entries(const Cryptomatte& matte) const {
        std::vector<MatteEntry> out;
        std::vector<std::size_t> parts;
        for (const MatteRank& rank : matte.ranks) {
            if (std::find(parts.begin(), parts.end(), rank.part) == parts.end()) parts.push_back(rank.part);
        }
        for (const std::size_t other : parts) {
            std::vector<std::string> names;
            for (const MatteRank& rank : matte.ranks) {
                if (rank.part == other) names.insert(names.end(), {rank.id, rank.coverage});
            }
            each_row_onto(file_, other, names, *part_,
                          [&](std::size_t first, std::size_t count, std::size_t from,
                              std::span<const float* const> values) {
                              for (std::size_t i = 0; i < count; ++i) {
                                  for (std::size_t c = 0; c < names.size(); c += 2) {
                                      const float share = values[c + 1][from + i];
                                      if (!(share >= least_share)) continue;  // also skips NaN
                                      if (out.size() == out.capacity()) {
                                          const std::size_t more = std::max(out.size() * 3 / 2, pixels());
                                          require_memory(more * sizeof(MatteEntry), "the Cryptomatte");
                                          out.reserve(more);
                                      }
                                      out.push_back({first + i,
                                                     {.id = surface_id(values[c][from + i], false),
                                                      .share = std::min(share, 1.0F),
                                                      .inverse_z = {}}});
                                  }
                              }
                          });
        }
        if (parts.size() > 1) {
            std::stable_sort(out.begin(), out.end(),
                             [](const MatteEntry& a, const MatteEntry& b) { return a.pixel < b.pixel; });
        }
        return out;
    }

    /// Sets the id of each sample of a flat image to that with the largest share of its pixel.
    void take_matte(const Cryptomatte& matte) {
        const std::vector<MatteEntry> entries = matte_entries(matte);
        require_memory(entries.size() * (sizeof(MixedPixel) + sizeof(SurfaceShare)), "the Cryptomatte");
        std::vector<SurfaceShare> here;
        for (std::size_t i = 0; i < entries.size();) {
            const std::size_t pixel = entries[i].pixel;
            here.clear();
            float sum = 0;
            for (; i < entries.size() && entries[i].pixel == pixel; ++i) {
                const SurfaceShare& s = entries[i].share;
                const auto same = std::find_if(here.begin(), here.end(),
                                               [&](const SurfaceShare& h) { return h.id == s.id; });
                if (same != here.end()) {
                    same->share += s.share;
                } else {
                    here.push_back(s);
                }
                sum += s.share;
            }
            add_shares(pixel, here, sum);
        }
    }

    void add_shares(std::size_t pixel, std::vector<SurfaceShare>& here, float sum) {
        if (1 - sum >= least_share) {
            const auto none =
                std::find_if(here.begin(), here.end(), [](const SurfaceShare& h) { return h.id == 0; });
            if (none != here.end()) {
                none->share += 1 - sum;
            } else {
                here.push_back({.id = 0, .share = 1 - sum, .inverse_z = {}});
            }
            sum = 1;
        }
        std::stable_sort(here.begin(), here.end(),
                         [](const SurfaceShare& a, const SurfaceShare& b) { return a.share > b.share; });
        for (std::uint64_t k = out_.offsets[pixel]; k < out_.offsets[pixel + 1]; ++k)
            out_.samples[k].id = here[0].id;
        if (here.size() == 1) return;
        out_.mixed.push_back({pixel, out_.shares.size(), here.size()});
        for (const SurfaceShare& h : here)
            out_.shares.push_back({.id = h.id, .share = h.share / sum, .inverse_z = {}});
    }

    /// Inverse depth of a value in the file, with its sign.
    float inverse(float value, int x, int y) {
        return inverse_of(encoding_ ? encoding_->distance(value) : value, x, y, value);
    }
    float inverse_of(float z, int x, int y, float value) {
        if (!(std::abs(z) < nothing_z) || z == 0) return 0;  // also NaN
        farthest_ = std::max(farthest_, std::abs(z));
        if (z < 0) {
            if (negative_ == 0) first_negative_ = {x, y, value};
            ++negative_;
        } else {
            ++positive_;
        }
        return 1 / z;
    }

    void add(const StackSample& s) {
        // A transparent black sample has no effect. NaN is handled later.
        if (s.alpha == 0 && s.r == 0 && s.g == 0 && s.b == 0) return;
        out_.samples.push_back(s);
    }

    float checked_alpha(float a) {
        if (a >= 0 && a <= 1) return a;
        // Amount by which an alpha that is a sum of rounded values may exceed the range from 0 to 1.
        constexpr float rounding = 2e-3F;
        if (!(a >= -rounding && a <= 1 + rounding)) ++bad_alphas_;
        return std::isnan(a) ? 1 : std::clamp(a, 0.0F, 1.0F);
    }

    void read_flat() {
        const ForeignChannels& c = out_.channels;
        constexpr float infinite = std::numeric_limits<float>::infinity();
        JoinedChannels channels(file_, c.part);
        const auto r = channels.add(c.part, c.r, 0), g = channels.add(c.part, c.g, 0),
                   b = channels.add(c.part, c.b, 0), a = channels.add(c.alpha_part, c.a, 0),
                   z = channels.add(c.depth_part, c.z, infinite), id = channels.add(c.id_part, c.id, 0),
                   ry = channels.add(c.part, c.ry, 0, true), by = channels.add(c.part, c.by, 0, true);
        if (ry) luminance_ = file_.luminance_weights(c.part);
        const auto width = static_cast<std::size_t>(part_->width());
        require_memory(pixels() * 2 * sizeof(float), "depths and alphas of the picture");
        std::vector<float> depths, covered;
        depths.reserve(pixels());
        covered.reserve(pixels());
        channels.read([&](int, std::span<const float* const> values) {
            make_room(width);
            for (std::size_t x = 0; x < width; ++x) {
                const auto value = [&](const std::optional<std::size_t>& channel, float otherwise) {
                    return channel ? values[*channel][x] : otherwise;
                };
                StackSample s{0,
                              value(r, 0),
                              value(g, 0),
                              value(b, 0),
                              checked_alpha(value(a, 1)),
                              surface_id(value(id, 0), whole_ids_)};
                if (ry) add_chroma(s, value(ry, 0), value(by, 0));
                depths.push_back(value(z, infinite));
                covered.push_back(s.alpha);
                add(s);
                out_.offsets.push_back(out_.samples.size());
            }
        });
        if (c.z.empty()) {
            out_.repairs.push_back(
                {"assumed", "no depth is in the file: all is taken to be infinitely far (--depth-channel)",
                 1});
        } else {
            take_depths(depths, covered);
        }
        if (c.matte) take_matte(*c.matte);
    }

    void add_chroma(StackSample& s, float ry, float by) const {
        const auto y = static_cast<double>(s.r);
        const double r = (static_cast<double>(ry) + 1) * y, b = (static_cast<double>(by) + 1) * y;
        s.r = static_cast<float>(r);
        s.g = static_cast<float>((y - luminance_[0] * r - luminance_[2] * b) / luminance_[1]);
        s.b = static_cast<float>(b);
    }

    /// Sets the depths of the samples from the values of the file.
    void take_depths(std::vector<float>& depths, const std::vector<float>& covered) {
        const auto width = static_cast<std::size_t>(part_->width());
        const FilteredDepths filtered = mend_filtered_depths(depths, covered, width, !out_.channels.matte);
        const auto place = [&](std::size_t i) {
            return std::pair(part_->data.x_min + static_cast<int>(i % width),
                             part_->data.y_min + static_cast<int>(i / width));
        };
        for (std::size_t i = 0; i < pixels(); ++i) {
            const auto [x, y] = place(i);
            for (std::uint64_t k = out_.offsets[i]; k < out_.offsets[i + 1]; ++k)
                out_.samples[k].inverse_z = inverse(depths[i], x, y);
        }
        const auto share = [&](std::size_t count) {
            return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(pixels(), 1));
        };
        if (filtered.divided > 0) {
            out_.repairs.push_back(
                {"repaired",
                 fmt::format("{} depths are multiplied by alpha: divided by it", filtered.divided),
                 share(filtered.divided)});
        }
        if (filtered.taken_over > 0) {
            out_.repairs.push_back(
                {"repaired",
                 fmt::format("{} depths of rims are means with nothing: they get that of their neighbours",
                             filtered.taken_over),
                 share(filtered.taken_over)});
        }
        if (filtered.mixed.empty()) return;
        out_.repairs.push_back(
            {"repaired",
             fmt::format("{} depths are means of near and far: each part of the pixel gets its own",
                         filtered.mixed.size()),
             share(filtered.mixed.size())});
        for (const MixedDepth& m : filtered.mixed) {
            const auto [x, y] = place(m.pixel);
            out_.mixed.push_back({m.pixel, out_.shares.size(), 2});
            out_.shares.push_back({0, m.near_share, inverse(m.near, x, y)});
            out_.shares.push_back({0, 1 - m.near_share, inverse(m.far, x, y)});
            if (m.near_share < 0.5F) std::swap(out_.shares.back(), *(out_.shares.end() - 2));
        }
    }

    void read_deep() {
        const auto width = static_cast<std::size_t>(part_->width());
        const ForeignChannels& c = out_.channels;
        ChannelList wanted;
        const auto r = wanted.add(c.r), g = wanted.add(c.g), b = wanted.add(c.b), a = wanted.add(c.a),
                   z = wanted.add(c.z), z_back = wanted.add(c.z_back), id = wanted.add(c.id);
        std::vector<DeepSample> pixel;
        file_.read_deep(c.part, wanted.names(), [&](const DeepRows& rows) {
            std::size_t at = 0;
            for (std::size_t i = 0; i < rows.count.size(); ++i) {
                const int x = part_->data.x_min + static_cast<int>(i % width),
                          y = rows.y_begin + static_cast<int>(i / width);
                pixel.clear();
                for (std::uint32_t k = 0; k < rows.count[i]; ++k, ++at) {
                    const auto value = [&](const std::optional<std::size_t>& channel, float otherwise) {
                        return channel ? rows.values[*channel][at] : otherwise;
                    };
                    const auto distance = [&](float v) { return encoding_ ? encoding_->distance(v) : v; };
                    DeepSample s{distance(value(z, 0)),
                                 distance(value(z_back, 0)),
                                 value(r, 0),
                                 value(g, 0),
                                 value(b, 0),
                                 checked_alpha(value(a, 1)),
                                 surface_id(value(id, 0), whole_ids_)};
                    pixel.push_back(s);
                }
                tidy_volumes(pixel);
                for (const DeepSample& s : pixel) add_volume(s, x, y);
                out_.offsets.push_back(out_.samples.size());
            }
        });
    }

    /// Adds a volume from z to z_back, divided into slices. Its density is constant, so equal distances have
    /// equal transmittance.
    void add_volume(const DeepSample& from, int x, int y) {
        const float z = from.z, z_back = from.z_back;
        const StackSample s{inverse_of(z, x, y, z), from.r, from.g, from.b, from.alpha, from.id};
        const double ratio = static_cast<double>(z_back) / static_cast<double>(z);
        int slices = 1;
        if (z > 0 && ratio > slice_ratio && z_back < nothing_z && s.alpha < 1)
            slices =
                std::min(most_slices, static_cast<int>(std::ceil(std::log(ratio) / std::log(slice_ratio))));
        make_room(static_cast<std::size_t>(slices));
        if (slices == 1) {
            add(s);
            return;
        }
        const double step = 1.0 / slices;
        const double alpha = -std::expm1(step * std::log1p(-static_cast<double>(s.alpha)));
        const auto share = static_cast<float>(s.alpha > 0 ? alpha / static_cast<double>(s.alpha) : step);
        for (int i = 0; i < slices; ++i) {
            StackSample slice = s;
            slice.inverse_z = static_cast<float>(
                1 / (static_cast<double>(z) + (i + 0.5) * step * static_cast<double>(z_back - z)));
            slice.r *= share;
            slice.g *= share;
            slice.b *= share;
            slice.alpha = static_cast<float>(alpha);
            add(slice);
        }
    }

    /// Converts depths to metres along the axis and sorts each stack, nearest first.
    void finish_depths() {
        if (negative_ > 0 && positive_ > 0) {
            fail(ExitCode::invalid_input,
                 "{}: channel {} at pixel {},{} is unusable (got {}; expected a depth of 0 or more, or none "
                 "such)",
                 file_.name(), out_.channels.z, first_negative_.x, first_negative_.y, first_negative_.z);
        }
        if (negative_ > 0) {
            out_.repairs.push_back(
                {"assumed", "all depths are negative: their size is taken as the distance", 1});
        }
        warn_of_encoding();
        const auto width = static_cast<std::size_t>(part_->width());
        const auto scaled = [](float inverse_z, float scale) {
            const float out = std::abs(inverse_z) * scale;
            return std::isfinite(out) ? out : std::numeric_limits<float>::max();
        };
        parallel_for(static_cast<std::size_t>(part_->height()), [&](std::size_t row) {
            for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
                const float scale = depth_scale(i);
                const auto stack =
                    std::span(out_.samples).subspan(out_.offsets[i], out_.offsets[i + 1] - out_.offsets[i]);
                for (StackSample& s : stack) s.inverse_z = scaled(s.inverse_z, scale);
                std::stable_sort(stack.begin(), stack.end(), [](const StackSample& a, const StackSample& b) {
                    return a.inverse_z > b.inverse_z;
                });
            }
        });
        for (const MixedPixel& m : out_.mixed) {
            for (std::size_t k = m.first; k < m.first + m.count; ++k) {
                auto& inverse_z = out_.shares[k].inverse_z;
                if (inverse_z) inverse_z = scaled(*inverse_z, depth_scale(m.pixel));
            }
        }
    }

    /// Factor from the inverse depth of the file to the inverse depth along the axis in 1/m, at a pixel.
    [[nodiscard]] float depth_scale(std::size_t pixel) const {
        const auto width = static_cast<std::size_t>(part_->width());
        const ForeignCamera& camera = out_.camera;
        const double pitch = out_.pixel_pitch_mm() / camera.film_distance_mm;
        const std::size_t column = pixel % width, row = pixel / width;
        const double u = (out_.x_begin + static_cast<double>(column) + 0.5 - out_.width / 2.0) * pitch,
                     v = (out_.y_begin + static_cast<double>(row) + 0.5 - out_.height / 2.0) * pitch;
        const bool along_ray = camera.depth_along == DepthAlong::ray;
        return static_cast<float>((along_ray ? std::sqrt(1 + u * u + v * v) : 1) / camera.metres_per_unit);
    }

    /// Warns if all depths are between 0 and 1. Scenes within one unit are rare, but other encodings have
    /// this range.
    void warn_of_encoding() {
        if (encoding_ || negative_ + positive_ == 0 || farthest_ > 1) return;
        out_.repairs.push_back(
            {"assumed",
             fmt::format("no depth is beyond {:.6g}: they may be inverse or normalized, and are taken as "
                         "distances (--depth-encoding)",
                         farthest_),
             1});
    }

    static bool finite(const StackSample& s) {
        return std::isfinite(s.r) && std::isfinite(s.g) && std::isfinite(s.b);
    }

    /// Replaces colours that are not finite, using only original colours, so that the order does not matter.
    void mend_colours() {
        std::vector<std::pair<std::size_t, StackSample>> mended;
        const int width = part_->width(), height = part_->height();
        for (std::size_t i = 0; i < pixels(); ++i) {
            for (std::uint64_t k = out_.offsets[i]; k < out_.offsets[i + 1]; ++k) {
                if (finite(out_.samples[k])) continue;
                StackSample s = out_.samples[k];
                s.r = s.g = s.b = 0;
                if (!out_.deep)
                    s = mean_around(s, static_cast<int>(i) % width, static_cast<int>(i) / width, height);
                mended.emplace_back(k, s);
            }
        }
        for (const auto& [k, s] : mended) out_.samples[k] = s;
        bad_colours_ = mended.size();
    }

    StackSample mean_around(StackSample s, int x, int y, int height) const {
        const int width = part_->width();
        std::array<double, 3> sum{};
        int count = 0;
        for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
            for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
                const auto around = out_.stack(out_.x_begin + u, out_.y_begin + v);
                if (around.empty() || !finite(around[0])) continue;
                sum[0] += static_cast<double>(around[0].r);
                sum[1] += static_cast<double>(around[0].g);
                sum[2] += static_cast<double>(around[0].b);
                ++count;
            }
        }
        if (count == 0) return s;
        s.r = static_cast<float>(sum[0] / count);
        s.g = static_cast<float>(sum[1] / count);
        s.b = static_cast<float>(sum[2] / count);
        return s;
    }

    void report() {
        const auto share = [&](std::size_t count) {
            return std::min(
                1.0, static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(pixels(), 1)));
        };
        if (bad_colours_ > 0) {
            out_.repairs.push_back(
                {"repaired",
                 fmt::format("{} samples have colours that are not finite: {}", bad_colours_,
                             out_.deep ? "taken as black" : "they get the mean of those around"),
                 share(bad_colours_)});
        }
        if (bad_alphas_ > 0) {
            out_.repairs.push_back(
                {"repaired",
                 fmt::format("{} samples have an alpha beyond 0 to 1: it is cut off", bad_alphas_),
                 share(bad_alphas_)});
        }
    }

    struct Place {
        int x = 0, y = 0;
        float z = 0;
    };
    ForeignFile file_;
    const ForeignPart* part_ = nullptr;
    bool whole_ids_ = false;
    std::optional<DepthEncoding> encoding_;
    std::array<double, 3> luminance_{};
    float farthest_ = 0;  ///< largest finite depth, in the file's unit
    ForeignPicture out_;
    std::size_t negative_ = 0, positive_ = 0, bad_alphas_ = 0, bad_colours_ = 0;
    Place first_negative_;
};

}  // namespace

std::uint32_t surface_id(float value, bool whole) {
    return !whole && (value == 0 || std::isnan(value)) ? 0 : std::bit_cast<std::uint32_t>(value);
}

Image ForeignPicture::flattened() const {
    require_memory(static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * 4 * sizeof(float),
                   "the picture of the display window");
    Image out(width, height);
    std::vector<float> alpha(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0F);
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < width; ++x) {
            if (!stores(x, y)) continue;
            double left = 1, held_out = 0;
            std::array<double, 3> rgb{};
            for (const StackSample& s : stack(x, y)) {
                if (s.holdout) {
                    held_out += left * static_cast<double>(s.alpha);
                } else {
                    rgb[0] += left * static_cast<double>(s.r);
                    rgb[1] += left * static_cast<double>(s.g);
                    rgb[2] += left * static_cast<double>(s.b);
                }
                left *= 1 - static_cast<double>(s.alpha);
            }
            for (std::size_t c = 0; c < 3; ++c) out.pixel(x, y)[c] = static_cast<float>(rgb[c]);
            alpha[row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                static_cast<float>(std::max(0.0, 1 - left - held_out));
        }
    });
    if (std::any_of(alpha.begin(), alpha.end(), [](float a) { return a < 1; })) out.alpha = std::move(alpha);
    return out;
}

double ForeignPicture::depth_at(double x, double y) const {
    const double column = std::floor(x), row = std::floor(y);
    if (!(column >= x_begin && column < x_end && row >= y_begin && row < y_end)) {
        fail(ExitCode::wrong_arguments, "--focus-at: out of range (got {},{}; expected 0 to {}, 0 to {})", x,
             y, width, height);
    }
    const StackSample* seen = seen_sample(static_cast<int>(column), static_cast<int>(row));
    return seen != nullptr && seen->inverse_z > 0 ? 1 / static_cast<double>(seen->inverse_z)
                                                  : std::numeric_limits<double>::infinity();
}

ForeignPicture read_foreign_picture(const std::filesystem::path& path, const ForeignChoice& choice,
                                    const ForeignCameraChoice& camera) {
    return Reader(path, choice, camera).read();
}

}  // namespace postlens
