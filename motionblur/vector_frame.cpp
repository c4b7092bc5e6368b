#include "motionblur/vector_frame.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

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
        find_ids(choice.ids, out);
        rgb_ = {list_.add(colours_.r), list_.add(colours_.g), list_.add(colours_.b)};
        u_ = list_.add(vectors_.u);
        v_ = list_.add(vectors_.v);
        z_ = list_.add(colours_.z);
        alpha_ = list_.add(colours_.a);
        id_ = list_.add(out.id_name);
        whole_ids_ = file_.kind(colours_.part, out.id_name) == ChannelKind::whole;
        file_.read_flat(colours_.part, list_.names(), [&](int y, std::span<const float* const> values) {
            for (int x = 0; x < part_->width(); ++x) out.pixels.push_back(pixel(values, x, y));
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

    /// Ids have to lie in the part of the colours.
    void find_ids(const std::string& asked, VectorFrame& out) const {
        out.problems = colours_.problems;
        const std::string& name = colours_.matte ? colours_.matte->ranks[0].id : colours_.id;
        const std::size_t part = colours_.matte ? colours_.matte->ranks[0].part : colours_.id_part;
        if (name.empty() || part == colours_.part) {
            out.id_name = name;
            return;
        }
        if (!asked.empty()) {
            fail(ExitCode::invalid_input,
                 "{}: ids {} are unusable (got part {}; expected them in part {}, beside the colours)",
                 file_.name(), asked, part, colours_.part);
        }
        out.problems.push_back(
            fmt::format("ids {} are not used: they lie in part {}, the colours and vectors in part {}", name,
                        part, colours_.part));
    }

    [[noreturn]] void refuse(const std::string& channel, int x, int y, float got,
                             const char* expected) const {
        fail(ExitCode::invalid_input, "{}: channel {} at pixel {},{} is unusable (got {}; expected {})",
             file_.name(), channel, part_->data.x_min + x, y, got, expected);
    }

    VectorPixel pixel(std::span<const float* const> values, int x, int y) const {
        const auto finite = [&](std::optional<std::size_t> channel) {
            const float v = values[*channel][x];
            if (!std::isfinite(v)) refuse(list_.names()[*channel], x, y, v, "a finite number");
            return v;
        };
        const auto vector_px = [&](std::optional<std::size_t> channel, double scale) {
            const float v = finite(channel);
            const double px = scale * static_cast<double>(v);
            if (!(std::abs(px) <= longest_vector))
                refuse(list_.names()[*channel], x, y, v, "a vector of at most 1e6 px");
            return static_cast<float>(px);
        };
        VectorPixel out;
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c] = finite(rgb_[c]);
        out.right_px = vector_px(u_, vectors_.scale.x);
        out.down_px = vector_px(v_, vectors_.scale.y);
        if (z_) {
            const float z = values[*z_][x];
            if (!(z >= 0)) refuse(list_.names()[*z_], x, y, z, "a depth of 0 or more");
            out.inverse_z = z == 0 || z >= background_z ? 0 : 1 / z;
        } else {
            // Parallax: any growing function of the speed will do.
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
    ChannelList list_;
    std::array<std::optional<std::size_t>, 3> rgb_;
    std::optional<std::size_t> u_, v_, z_, alpha_, id_;
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
