#include "motionblur/vector_frame.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/memory.h"
#include "records/foreign_channels.h"
#include "records/foreign_picture.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr float background_z = 1e9F;    ///< renderers write 1e9, 1e10 or infinity where a ray hits nothing
constexpr double longest_vector = 1e6;  ///< px
constexpr std::uint64_t most_pixels = 1U
                                      << 29U;  ///< of both windows; four vertices each are counted in 32 bits

class Reader {
  public:
    explicit Reader(const fs::path& path) : file_(path) {}

    VectorFrame read(const VectorChoice& choice, const std::string& layer) {
        find_part(choice, layer);
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
        std::vector<std::string> names{colours_.r, colours_.g, colours_.b, vectors_.u, vectors_.v};
        if (out.has_z) names.push_back(colours_.z);
        if (out.has_alpha) names.push_back(colours_.a);
        alpha_ = names.size() - 1;
        out.id_name = id_channel();
        if (!out.id_name.empty()) names.push_back(out.id_name);
        whole_ids_ = file_.kind(colours_.part, out.id_name) == ChannelKind::whole;
        file_.read_flat(colours_.part, names, [&](int y, std::span<const float* const> values) {
            for (int x = 0; x < part_->width(); ++x) out.pixels.push_back(pixel(values, names, out, x, y));
        });
        for (const VectorPixel& p : out.pixels) {
            out.largest_px = std::max(
                out.largest_px, std::hypot(static_cast<double>(p.right_px), static_cast<double>(p.down_px)));
        }
        return out;
    }

  private:
    static std::uint64_t pixels(int width, int height) {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }

    /// Where the colours lie, and the vectors with them.
    void find_part(const VectorChoice& choice, const std::string& layer) {
        const auto of_part = [&](const ForeignPart& part) {
            const std::string hero = part.views.empty() ? "" : part.views[0];
            return find_vector_channels(part.channels, hero, choice, file_.name());
        };
        if (file_.parts()[0].deep) {
            fail(ExitCode::invalid_input, "{}: cannot read (got deep pixels; expected a flat picture)",
                 file_.name());
        }
        if (file_.parts().size() == 1) vectors_ = of_part(file_.parts()[0]);
        // The passes of one layer belong together.
        const std::string& passes = vectors_.layer;
        const bool own = layer.empty() && !passes.empty() && !file_.parts()[0].has("R") &&
                         file_.parts()[0].has(passes + "Combined.R");
        colours_ =
            find_foreign_channels(file_, {own ? passes.substr(0, passes.size() - 1) : layer, "", choice.ids});
        part_ = &file_.parts()[colours_.part];
        if (part_->deep) {
            fail(ExitCode::invalid_input, "{}: cannot read (got deep pixels; expected a flat picture)",
                 file_.name());
        }
        if (file_.parts().size() > 1) vectors_ = of_part(*part_);
        if (colours_.r.empty()) {
            fail(ExitCode::invalid_input, "{}: no colours (got channels {}; expected R, G and B)",
                 file_.name(), listed(part_->channels));
        }
        if (colours_.depth_part != colours_.part) colours_.z.clear();
    }

    /// Of ids in the part of the colours; empty: none.
    [[nodiscard]] std::string id_channel() const {
        const std::string& name = colours_.matte ? colours_.matte->ranks[0].id : colours_.id;
        const std::size_t part = colours_.matte ? colours_.matte->ranks[0].part : colours_.id_part;
        return part == colours_.part ? name : "";
    }

    [[noreturn]] void refuse(const std::string& channel, int x, int y, float got,
                             const char* expected) const {
        fail(ExitCode::invalid_input, "{}: channel {} at pixel {},{} is unusable (got {}; expected {})",
             file_.name(), channel, part_->data.x_min + x, y, got, expected);
    }

    VectorPixel pixel(std::span<const float* const> values, const std::vector<std::string>& names,
                      const VectorFrame& frame, int x, int y) const {
        const auto finite = [&](std::size_t channel) {
            const float v = values[channel][x];
            if (!std::isfinite(v)) refuse(names[channel], x, y, v, "a finite number");
            return v;
        };
        const auto vector_px = [&](std::size_t channel, double scale) {
            const float v = finite(channel);
            const double px = scale * static_cast<double>(v);
            if (!(std::abs(px) <= longest_vector))
                refuse(names[channel], x, y, v, "a vector of at most 1e6 px");
            return static_cast<float>(px);
        };
        VectorPixel out;
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c] = finite(c);
        out.right_px = vector_px(3, vectors_.scale.x);
        out.down_px = vector_px(4, vectors_.scale.y);
        if (frame.has_z) {
            const float z = values[5][x];
            if (!(z >= 0)) refuse(names[5], x, y, z, "a depth of 0 or more");
            out.inverse_z = z == 0 || z >= background_z ? 0 : 1 / z;
        } else {
            // Parallax: any growing function of the speed will do.
            out.inverse_z = 1 + std::hypot(out.right_px, out.down_px);
        }
        if (frame.has_alpha && finite(alpha_) == 0) out.inverse_z = 0;
        if (!frame.id_name.empty()) out.id = surface_id(values.back()[x], whole_ids_);
        return out;
    }

    ForeignFile file_;
    const ForeignPart* part_ = nullptr;
    ForeignChannels colours_;
    VectorChannels vectors_;
    std::size_t alpha_ = 0;  ///< of the channels read
    bool whole_ids_ = false;
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

VectorFrame read_vector_frame(const fs::path& path, const VectorChoice& choice, const std::string& layer) {
    return Reader(path).read(choice, layer);
}

}  // namespace postlens
