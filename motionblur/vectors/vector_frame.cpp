#include "motionblur/vectors/vector_frame.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/memory.h"
#include "pictures/foreign/foreign_depths.h"
#include "pictures/foreign/foreign_picture.h"
#include "pictures/foreign/foreign_planes.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr double longest_vector = 1e6;  ///< largest accepted length of a vector, px
/// Largest accepted number of pixels in the data window of a file (its stored pixels) together with its
/// display window (the visible image). The pixels are numbered by integers of 32 bits. Some of these bits
/// serve as flags, so fewer than 2^32 numbers are available.
constexpr std::uint64_t most_pixels = 1U << 29U;

class Reader {
  public:
    Reader(const fs::path& path, const VectorChoice& vectors, const ForeignChoice& choice)
        : file_(open_foreign_file(path, choice)), encoding_(choice.depth_encoding) {
        if (file_.parts()[0].deep) refuse_deep();
        if (!vectors.file.empty()) file_.attach(vectors.file, PartUse::vectors);
        find_channels(vectors, choice);
    }

    VectorFrame read() {
        const Window& data = part_->data;
        const Window& display = part_->display;
        VectorFrame out;
        out.width = display.x_max - display.x_min + 1;
        out.height = display.y_max - display.y_min + 1;
        out.x_begin = data.x_min - display.x_min;
        out.y_begin = data.y_min - display.y_min;
        out.x_end = out.x_begin + part_->width();
        out.y_end = out.y_begin + part_->height();
        const std::uint64_t stored = pixels(part_->width(), part_->height()),
                            shown = pixels(out.width, out.height);
        if (stored + shown > most_pixels) {
            fail(ExitCode::invalid_input,
                 "{}: windows are out of bounds (got {} px; expected 2^29 px together)", file_.name(),
                 stored + shown);
        }
        require_memory(stored * sizeof(VectorPixel) + shown * 3 * sizeof(float), "the picture");
        out.u_name = vectors_.u;
        out.v_name = vectors_.v;
        out.has_z = !colours_.z.empty();
        out.has_alpha = !colours_.a.empty();
        out.problems = colours_.problems;
        out.assumed = colours_.assumed;
        if (!vectors_.assumed.empty()) out.assumed.push_back(vectors_.assumed);
        out.id_name = colours_.matte ? colours_.matte->ranks[0].id : colours_.id;
        const std::size_t id_part = colours_.matte ? colours_.matte->ranks[0].part : colours_.id_part;
        const ForeignChannels& c = colours_;
        list_.emplace(file_, c.part);
        // Adds the needed channels of the OpenEXR file to a list. The last argument of add() is the value of
        // the channel in pixels that the file does not store. So these pixels are black, static and
        // infinitely far away.
        rgb_ = {list_->add(c.part, c.r, 0), list_->add(c.part, c.g, 0), list_->add(c.part, c.b, 0)};
        u_ = list_->add(vectors_.part, vectors_.u, static_cast<float>(vectors_.offset.x));
        v_ = list_->add(vectors_.part, vectors_.v, static_cast<float>(vectors_.offset.y));
        z_ = list_->add(c.depth_part, c.z, std::numeric_limits<float>::infinity());
        alpha_ = list_->add(c.alpha_part, c.a, 0);
        id_ = list_->add(id_part, out.id_name, 0, ChannelUse::id);
        whole_ids_ = file_.kind(id_part, out.id_name) == ChannelKind::whole;
        list_->read([&](int y, std::span<const float* const> values) {
            for (int x = 0; x < part_->width(); ++x) out.pixels.push_back(pixel(values, x, y));
        });
        for (const VectorPixel& p : out.pixels) {
            out.largest_px = std::max(
                out.largest_px, std::hypot(static_cast<double>(p.right_px), static_cast<double>(p.down_px)));
        }
        warn_of_offset(out);
        return out;
    }

  private:
    static std::uint64_t pixels(int width, int height) {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }

    [[noreturn]] void refuse_deep() const {
        fail(ExitCode::invalid_input, "{}: cannot read (got deep pixels; expected a flat picture)",
             file_.name());
    }

    /// Finds the channels of the colours and of their motion vectors. If the user selects no layer, uses the
    /// first layer that has motion vectors.
    void find_channels(const VectorChoice& vectors, const ForeignChoice& choice) {
        colours_ = find_foreign_channels(file_, choice);
        std::optional<ChannelGroup> other;
        auto found = find_vector_channels(file_, group_of(colours_), vectors, other);
        if (!found && other && choice.layer.empty()) {
            if (const auto layer = layer_of(*other)) {
                ForeignChoice with = choice;
                with.layer = *layer;
                colours_ = find_foreign_channels(file_, with);
                found = find_vector_channels(file_, group_of(colours_), vectors, other);
            }
        }
        part_ = &file_.parts()[colours_.part];
        if (part_->deep) refuse_deep();
        if (!found) {
            std::vector<std::string> names;
            for (const ForeignPart& part : file_.parts()) {
                if (part.use == PartUse::picture || part.use == PartUse::vectors)
                    names.insert(names.end(), part.channels.begin(), part.channels.end());
            }
            fail(ExitCode::invalid_input,
                 "{}: no motion vectors{} (got channels {}; expected forward.u and .v, Vector.Z and .W, "
                 "motion.x and .y, velocity.x and .y, or --vectors U,V)",
                 file_.name(), other ? " of the colours' own layer and view" : "", listed(names));
        }
        vectors_ = *found;
        if (colours_.r.empty()) {
            fail(ExitCode::invalid_input, "{}: no colours (got channels {}; expected R, G and B)",
                 file_.name(), listed(part_->channels));
        }
    }

    [[nodiscard]] ChannelGroup group_of(const ForeignChannels& c) const {
        return channel_group(file_, c.part, c.layer, colour_words);
    }

    /// Returns the argument with which the option --layer selects the colours of `group` (a stereo view and a
    /// layer of the file). Returns empty if the file has no such colours.
    [[nodiscard]] std::optional<std::string> layer_of(const ChannelGroup& group) const {
        for (std::size_t i = 0; i < file_.parts().size(); ++i) {
            const ForeignPart& part = file_.parts()[i];
            if (part.use != PartUse::picture) continue;
            for (const std::string& layer : colour_layers(part)) {
                const ChannelGroup own = channel_group(file_, i, layer, colour_words);
                if (own.view != group.view || own.layer != group.layer) continue;
                if (!layer.empty()) return layer.substr(0, layer.size() - 1);
                if (!part.name.empty()) return part.name;
            }
        }
        return std::nullopt;
    }

    void warn_of_offset(VectorFrame& out) const {
        if (vectors_.offset != glm::dvec2(0, 0) || out.pixels.empty()) return;
        std::size_t in_the_middle = 0;
        for (const VectorPixel& p : out.pixels) {
            const glm::dvec2 value = glm::dvec2(p.right_px, p.down_px) / vectors_.scale;
            if (!(value.x >= 0 && value.x <= 1 && value.y >= 0 && value.y <= 1)) return;
            constexpr double near = 0.005;
            in_the_middle += std::abs(value.x - 0.5) < near && std::abs(value.y - 0.5) < near ? 1 : 0;
        }
        if (5 * in_the_middle < out.pixels.size()) return;
        out.assumed.push_back(
            fmt::format("{} and {} lie between 0 and 1, many in the middle: they may have an offset, and are "
                        "taken without one (--vector-offset, --vector-scale)",
                        out.u_name, out.v_name));
    }

    [[noreturn]] void refuse(const std::string& channel, int x, int y, float got,
                             const char* expected) const {
        fail(ExitCode::invalid_input, "{}: channel {} at pixel {},{} is unusable (got {}; expected {})",
             file_.name(), channel, part_->data.x_min + x, y, got, expected);
    }

    VectorPixel pixel(std::span<const float* const> values, int x, int y) const {
        const auto finite = [&](std::optional<std::size_t> channel) {
            const float v = values[*channel][x];
            if (!std::isfinite(v)) refuse(list_->name(*channel), x, y, v, "a finite number");
            return v;
        };
        const auto vector_px = [&](std::optional<std::size_t> channel, double offset, double scale) {
            const float v = finite(channel);
            const double px = scale * (static_cast<double>(v) - offset);
            if (!(std::abs(px) <= longest_vector))
                refuse(list_->name(*channel), x, y, v, "a vector of at most 1e6 px");
            return static_cast<float>(px);
        };
        VectorPixel out;
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c] = finite(rgb_[c]);
        out.right_px = vector_px(u_, vectors_.offset.x, vectors_.scale.x);
        out.down_px = vector_px(v_, vectors_.offset.y, vectors_.scale.y);
        if (z_) {
            const float stored = values[*z_][x], z = encoding_ ? encoding_->distance(stored) : stored;
            if (!(z >= 0)) refuse(list_->name(*z_), x, y, stored, "a depth of 0 or more");
            out.inverse_z = z == 0 || z >= ForeignDepths::nothing_z ? 0 : 1 / z;
        } else {
            // Without depth, faster pixels count as nearer.
            out.inverse_z = 1 + std::hypot(out.right_px, out.down_px);
        }
        if (alpha_ && finite(alpha_) == 0) out.inverse_z = 0;
        if (id_) out.id = surface_id(values[*id_][x], whole_ids_);
        return out;
    }

    ForeignFile file_;
    const ForeignPart* part_ = nullptr;
    ForeignChannels colours_;
    VectorChannels vectors_;
    std::optional<JoinedChannels> list_;
    std::array<std::optional<std::size_t>, 3> rgb_;
    std::optional<std::size_t> u_, v_, z_, alpha_, id_;
    bool whole_ids_ = false;
    std::optional<DepthEncoding> encoding_;
};

}  // namespace

Image VectorFrame::picture() const {
    Image out(width, height);
    for (int y = std::max(0, y_begin); y < std::min(height, y_end); ++y) {
        for (int x = std::max(0, x_begin); x < std::min(width, x_end); ++x)
            std::copy_n(at(x, y).rgb.begin(), 3, out.pixel(x, y));
    }
    return out;
}

VectorFrame read_vector_frame(const fs::path& path, const VectorChoice& vectors,
                              const ForeignChoice& choice) {
    return Reader(path, vectors, choice).read();
}

}  // namespace postlens
