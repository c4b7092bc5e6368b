// Reads an OpenEXR image that another program wrote, and repairs faulty values.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/counted.h"
#include "core/error.h"
#include "core/memory.h"
#include "pictures/foreign/deep_volumes.h"
#include "pictures/foreign/foreign_depths.h"
#include "pictures/foreign/foreign_picture.h"
#include "pictures/foreign/foreign_planes.h"
#include "pictures/foreign/matte_shares.h"
#include "pictures/foreign/mend_colours.h"

namespace postlens {
namespace {

/// A volume is a deep sample that extends from a front depth to a back depth. It is divided into at most
/// `most_slices` slices, so that the circle of confusion varies little within a slice. `slice_ratio` is the
/// intended ratio of a slice's far depth to its near depth.
constexpr double slice_ratio = 1.02;
constexpr int most_slices = 32;
/// If a volume begins nearer to the camera than this fraction of its far depth, its first slice ends there.
/// The near depth of this slice may be 0, so no ratio of depths can define its end.
constexpr double first_slice = 1e-2;

/// Converts another program's image file to one stack of samples (colours with depths) per pixel.
class Reader {
  public:
    Reader(const std::filesystem::path& path, const ForeignChoice& choice, const ForeignCameraChoice& camera)
        : file_(open_foreign_file(path, choice)), depths_(choice.depth_encoding) {
        out_.channels = find_foreign_channels(file_, choice);
        part_ = &file_.parts()[out_.channels.part];
        out_.deep = part_->deep;
        out_.width = part_->display.x_max - part_->display.x_min + 1;
        out_.height = part_->display.y_max - part_->display.y_min + 1;
        out_.x_begin = part_->data.x_min - part_->display.x_min;
        out_.y_begin = part_->data.y_min - part_->display.y_min;
        out_.x_end = out_.x_begin + part_->width();
        out_.y_end = out_.y_begin + part_->height();
        // The pixel grid must contain both the display window (the rectangle of the whole image) and the data
        // window (the rectangle of the stored pixels). If these are far apart, this would need too much
        // memory, so it is an error.
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
        out_.whole_ids = !c.id.empty() && file_.kind(c.id_part, c.id) == ChannelKind::whole;
        for (const std::string& problem : c.problems) out_.repairs.push_back({"ids", problem, 0});
        for (const std::string& text : c.assumed) out_.repairs.push_back({"assumed", text, 0});
        take_pixel_aspect(file_.number(c.part, "pixelAspectRatio").value_or(1));
    }

    ForeignPicture read() {
        if (part_->deep) {
            read_deep();
        } else {
            read_flat();
        }
        depths_.finish(file_, *part_, out_);
        if (!finite_colours_) bad_colours_ = mend_colours(out_);
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

    /// Determines the camera, and the frame (the display window without overscan).
    void take_camera(ForeignCameraChoice choice) {
        const int margin = choice.overscan_px;
        if (margin < 0 || 2 * margin >= std::min(out_.width, out_.height)) {
            fail(ExitCode::wrong_arguments,
                 "--overscan: leaves no frame (got {}; expected 0 to {} for the {}x{} px of {})", margin,
                 (std::min(out_.width, out_.height) - 1) / 2, out_.width, out_.height, file_.name());
        }
        const double of_frame = static_cast<double>(out_.width - 2 * margin) / out_.width;
        // The user states the film width of the image without overscan (the margin of extra pixels), but
        // foreign_camera() expects that of the whole file. `of_frame` is the fraction of the file's width
        // that is not overscan.
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

    void take_pixel_aspect(double aspect) {
        constexpr double least = 0.1, most = 10;
        if (aspect >= least && aspect <= most) {
            out_.pixel_aspect = aspect;
            return;
        }
        out_.repairs.push_back(
            {"assumed",
             fmt::format(
                 "pixelAspectRatio is unusable (got {:g}; expected {} to {}): pixels are taken as square",
                 aspect, least, most),
             0});
    }

    void add(const StackSample& s) {
        // A black sample with alpha 0 has no effect and is dropped. Samples with NaN are kept, because they
        // are repaired later.
        if (s.alpha == 0 && s.r == 0 && s.g == 0 && s.b == 0) return;
        finite_colours_ = finite_colours_ && has_finite_colour(s);
        out_.samples.push_back(s);
    }

    float checked_alpha(float a) {
        if (a >= 0 && a <= 1) return a;
        // Alphas may be outside 0 to 1 by this much without a warning, because they may be sums of rounded
        // values.
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
                   z = channels.add(c.depth_part, c.z, infinite),
                   id = channels.add(c.id_part, c.id, 0, ChannelUse::id),
                   ry = channels.add(c.part, c.ry, 0, ChannelUse::interpolated),
                   by = channels.add(c.part, c.by, 0, ChannelUse::interpolated);
        std::optional<MatteShares> matte;
        std::vector<std::size_t> of_matte;
        if (c.matte) {
            matte.emplace(file_, *part_, *c.matte);
            for (const std::string& name : matte->begin_beside(c.part))
                of_matte.push_back(*channels.add(c.part, name, 0));
        }
        std::vector<const float*> matte_row(of_matte.size());
        if (ry) luminance_ = file_.luminance_weights(c.part);
        const auto width = static_cast<std::size_t>(part_->width());
        require_memory(pixels() * 2 * sizeof(float), "depths and alphas of the picture");
        std::vector<float> depths, covered;
        depths.reserve(pixels());
        covered.reserve(pixels());
        // Reserves memory to avoid copies of growing lists. The size is limited, because a damaged file may
        // claim more pixels than it contains.
        constexpr std::size_t most_at_once = std::size_t{1} << 22;
        out_.offsets.reserve(std::min(pixels(), most_at_once) + 1);
        // A mixed pixel later gets several samples (unmix_edges).
        make_room(std::min(pixels() + pixels() / 8, most_at_once));
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
                              surface_id(value(id, 0), out_.whole_ids)};
                if (ry) add_chroma(s, value(ry, 0), value(by, 0));
                depths.push_back(value(z, infinite));
                covered.push_back(s.alpha);
                add(s);
                out_.offsets.push_back(out_.samples.size());
            }
            if (of_matte.empty()) return;
            for (std::size_t i = 0; i < of_matte.size(); ++i) matte_row[i] = values[of_matte[i]];
            matte->take(depths.size() - width, width, matte_row, out_);
        });
        if (c.z.empty()) {
            out_.repairs.push_back(
                {"assumed", "no depth is in the file: all is taken to be infinitely far (--depth-channel)",
                 1});
        } else {
            depths_.take(*part_, depths, covered, out_);
        }
        if (matte) matte->finish(out_);
    }

    void add_chroma(StackSample& s, float ry, float by) const {
        const auto y = static_cast<double>(s.r);
        const double r = (static_cast<double>(ry) + 1) * y, b = (static_cast<double>(by) + 1) * y;
        s.r = static_cast<float>(r);
        s.g = static_cast<float>((y - luminance_[0] * r - luminance_[2] * b) / luminance_[1]);
        s.b = static_cast<float>(b);
    }

    void read_deep() {
        const auto width = static_cast<std::size_t>(part_->width());
        const ForeignChannels& c = out_.channels;
        ChannelList wanted;
        const auto r = wanted.add(c.r), g = wanted.add(c.g), b = wanted.add(c.b), a = wanted.add(c.a),
                   z = wanted.add(c.z), z_back = wanted.add(c.z_back), id = wanted.add(c.id);
        std::vector<bool> whole;  // per channel, whether its values are integers
        for (const std::string& name : wanted.names())
            whole.push_back(file_.kind(c.part, name) == ChannelKind::whole);
        std::vector<DeepSample> pixel;
        file_.read_deep(c.part, wanted.names(), [&](const DeepRows& rows) {
            std::size_t at = 0;
            for (std::size_t i = 0; i < rows.count.size(); ++i) {
                const int x = part_->data.x_min + static_cast<int>(i % width),
                          y = rows.y_begin + static_cast<int>(i / width);
                pixel.clear();
                for (std::uint32_t k = 0; k < rows.count[i]; ++k, ++at) {
                    const auto value = [&](const std::optional<std::size_t>& channel, float otherwise) {
                        if (!channel) return otherwise;
                        const float stored = rows.values[*channel][at];
                        return whole[*channel] ? number_of_bits(stored) : stored;
                    };
                    // A volume lies between a front depth and a back depth.
                    const float front = depths_.distance(value(z, 0)),
                                back = z_back ? depths_.distance(value(z_back, 0)) : 0;
                    depths_.note(front, x, y, value(z, 0));
                    // `end` is the depth at which the sample ends; 0 if the file states none. If the front
                    // depth is negative, the file stores all depths as negative numbers, so the sign of the
                    // back depth is changed, too. A front depth of 0 (the camera is inside the volume) does
                    // not tell the sign.
                    const float end = !ForeignDepths::is_hit(back) ? 0
                                      : front == 0                 ? std::abs(back)
                                                                   : std::copysign(1.0F, front) * back;
                    DeepSample s{std::abs(front),
                                 end,
                                 value(r, 0),
                                 value(g, 0),
                                 value(b, 0),
                                 checked_alpha(value(a, 1)),
                                 surface_id(id ? rows.values[*id][at] : 0, out_.whole_ids)};
                    pixel.push_back(s);
                }
                tidy_volumes(pixel);
                for (const DeepSample& s : pixel) add_volume(s);
                out_.offsets.push_back(out_.samples.size());
            }
        });
    }

    /// Adds a deep sample to the current pixel's stack. If the sample is a volume (of constant density), it
    /// is divided into slices, so that the blur varies little within a slice. The far depth of each slice is
    /// its near depth times a constant ratio.
    void add_volume(const DeepSample& from) {
        const double z = from.z, z_back = from.z_back;
        const StackSample s{ForeignDepths::inverse_of(from.z), from.r, from.g, from.b, from.alpha, from.id};
        int slices = 1;
        if (z_back > z * slice_ratio && s.alpha < 1) {
            const double wanted =
                std::ceil(std::log(z_back / z) / std::log(slice_ratio));  // infinite if z is 0
            slices = static_cast<int>(std::min<double>(most_slices, wanted));
        }
        make_room(static_cast<std::size_t>(slices));
        if (slices == 1) {
            add(s);
            return;
        }
        const double first = z_back * first_slice;
        const bool begins_near = z < first;
        const double from_z = begins_near ? first : z;
        const int ratios = begins_near ? slices - 1 : slices;
        const double ratio = std::pow(z_back / from_z, 1.0 / ratios);
        double near = z;
        for (int i = 0; i < slices; ++i) {
            const double far = i + 1 == slices ? z_back
                               : begins_near   ? from_z * std::pow(ratio, i)
                                               : from_z * std::pow(ratio, i + 1);
            add_slice(s, near, far, (far - near) / (z_back - z));
            near = far;
        }
    }

    /// Adds the slice of a volume between the depths `near` and `far` to the pixel's stack. `s` holds the
    /// colour and alpha of the whole volume. `part` is the length of the slice as a fraction of the volume's
    /// length.
    void add_slice(const StackSample& s, double near, double far, double part) {
        const double whole = static_cast<double>(s.alpha);
        const double alpha = -std::expm1(part * std::log1p(-whole));
        const auto share = static_cast<float>(whole > 0 ? alpha / whole : part);
        StackSample slice = s;
        slice.inverse_z = static_cast<float>(2 / (near + far));
        slice.r *= share;
        slice.g *= share;
        slice.b *= share;
        slice.alpha = static_cast<float>(alpha);
        add(slice);
    }

    void report() {
        const auto share = [&](std::size_t count) {
            return std::min(
                1.0, static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(pixels(), 1)));
        };
        for (const auto& [count, instead] :
             {std::pair(bad_colours_.by_mean, "the mean of those around instead"),
              {bad_colours_.by_black, "taken as black"}}) {
            if (count == 0) continue;
            out_.repairs.push_back(
                {"repaired",
                 fmt::format("{} with colours that are not finite: {}", counted(count, "sample"), instead),
                 share(count)});
        }
        if (bad_alphas_ > 0) {
            out_.repairs.push_back(
                {"repaired",
                 fmt::format("{} with an alpha beyond 0 to 1: cut off", counted(bad_alphas_, "sample")),
                 share(bad_alphas_)});
        }
    }

    ForeignFile file_;
    const ForeignPart* part_ = nullptr;
    ForeignDepths depths_;
    std::array<double, 3> luminance_{};
    ForeignPicture out_;
    bool finite_colours_ = true;  ///< of all samples so far
    MendedColours bad_colours_;
    std::size_t bad_alphas_ = 0;
};

}  // namespace

ForeignPicture read_foreign_picture(const std::filesystem::path& path, const ForeignChoice& choice,
                                    const ForeignCameraChoice& camera) {
    return Reader(path, choice, camera).read();
}

}  // namespace postlens
