#include "motionblur/vector_frame.h"

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <memory>

#include "core/error.h"
#include "core/memory.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr int longest_edge = 1 << 16;   ///< px; half a pixel is exact in float far beyond
constexpr float background_z = 1e9F;    ///< renderers write 1e9, 1e10 or infinity where a ray hits nothing
constexpr double longest_vector = 1e6;  ///< px
constexpr int most_channels = 1024;
constexpr std::uint64_t most_pixels = 1U
                                      << 29U;  ///< of both windows; four vertices each are counted in 32 bits

std::string one_line(std::string text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "no reason given" : text;
}

/// The view whose channels carry no view's name: the first of `multiView`.
std::string hero_view(const OIIO::ImageSpec& spec) {
    const OIIO::ParamValue* views = spec.find_attribute("multiView");
    if (views == nullptr || views->type().basetype != OIIO::TypeDesc::STRING || views->nvalues() < 1)
        return "";
    return views->get_string_indexed(0);
}

class Reader {
  public:
    explicit Reader(const fs::path& path) : name_(path.string()), in_(OIIO::ImageInput::open(name_)) {
        if (!in_) fail(ExitCode::invalid_input, "{}: cannot read ({})", name_, one_line(OIIO::geterror()));
        const OIIO::ImageSpec& s = spec();
        if (s.deep) {
            fail(ExitCode::invalid_input, "{}: cannot read (got deep pixels; expected a flat picture)",
                 name_);
        }
        if (s.width < 1 || s.height < 1 || s.depth > 1 || s.full_width < 1 || s.full_height < 1 ||
            s.nchannels < 1 || s.nchannels > most_channels ||
            std::max({s.width, s.height, s.full_width, s.full_height}) > longest_edge ||
            std::abs(std::int64_t{s.x} - s.full_x) > longest_edge ||
            std::abs(std::int64_t{s.y} - s.full_y) > longest_edge ||
            pixels(s.width, s.height) + pixels(s.full_width, s.full_height) > most_pixels) {
            fail(ExitCode::invalid_input,
                 "{}: out of bounds (got {}x{} px at {},{} in {}x{} px at {},{} with {} channels; expected "
                 "edges and offsets of at most {} px, 2^29 px together and at most {} channels)",
                 name_, s.width, s.height, s.x, s.y, s.full_width, s.full_height, s.full_x, s.full_y,
                 s.nchannels, longest_edge, most_channels);
        }
        // A damaged header must not ask for much memory. Deflate, the densest of the formats, packs 1 to
        // 1032.
        std::error_code error;
        const std::uint64_t bytes = fs::file_size(path, error);
        const std::uint64_t needed = pixels(s.width, s.height) * sizeof(VectorPixel);
        constexpr std::uint64_t unquestioned = 256U << 20U;
        if (needed > unquestioned && needed / 4096 > bytes) {
            fail(ExitCode::invalid_input, "{}: header is damaged (got {}x{} pixels in {} bytes)", name_,
                 s.width, s.height, bytes);
        }
        require_memory(needed + pixels(s.width, s.height) * sizeof(float) +
                           pixels(s.full_width, s.full_height) * 3 * sizeof(float),
                       "the picture");
    }

    VectorFrame read(const VectorChoice& choice) {
        const OIIO::ImageSpec& s = spec();
        const VectorChannels c = find_vector_channels(s.channelnames, hero_view(s), choice, name_);
        VectorFrame out;
        out.width = s.full_width;
        out.height = s.full_height;
        out.x_begin = s.x - s.full_x;
        out.y_begin = s.y - s.full_y;
        out.x_end = out.x_begin + s.width;
        out.y_end = out.y_begin + s.height;
        out.u_name = c.u_name;
        out.v_name = c.v_name;
        out.has_z = c.z.has_value();
        out.has_alpha = c.a.has_value();
        out.pixels.resize(pixels(s.width, s.height));
        plane_.resize(out.pixels.size());
        const std::size_t colours[3] = {c.r, c.g, c.b};
        for (std::size_t k = 0; k < 3; ++k) {
            read_finite(colours[k], [&, k](std::size_t i, float v) { out.pixels[i].rgb[k] = v; });
        }
        const auto vector_px = [&](std::size_t channel, double scale, float VectorPixel::*to) {
            read_finite(channel, [&, channel](std::size_t i, float v) {
                const double px = scale * static_cast<double>(v);
                if (!(std::abs(px) <= longest_vector)) refuse(channel, i, v, "a vector of at most 1e6 px");
                out.pixels[i].*to = static_cast<float>(px);
            });
        };
        vector_px(c.u, c.scale.x, &VectorPixel::right_px);
        vector_px(c.v, c.scale.y, &VectorPixel::down_px);
        for (const VectorPixel& p : out.pixels) {
            out.largest_px = std::max(
                out.largest_px, std::hypot(static_cast<double>(p.right_px), static_cast<double>(p.down_px)));
        }
        read_depths(c, out);
        return out;
    }

  private:
    static std::uint64_t pixels(int width, int height) {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }
    [[nodiscard]] const OIIO::ImageSpec& spec() const { return in_->spec(); }

    void read_plane(std::size_t channel) {
        const int c = static_cast<int>(channel);
        if (!in_->read_image(0, 0, c, c + 1, OIIO::TypeDesc::FLOAT, plane_.data()))
            fail(ExitCode::invalid_input, "{}: cannot read ({})", name_, one_line(in_->geterror()));
    }

    [[noreturn]] void refuse(std::size_t channel, std::size_t pixel, float got, const char* expected) const {
        const auto width = static_cast<std::size_t>(spec().width);
        fail(ExitCode::invalid_input, "{}: channel {} at pixel {},{} is unusable (got {}; expected {})",
             name_, spec().channelnames[channel], spec().x + static_cast<int>(pixel % width),
             spec().y + static_cast<int>(pixel / width), got, expected);
    }

    template <typename Store>
    void read_finite(std::size_t channel, const Store& store) {
        read_plane(channel);
        for (std::size_t i = 0; i < plane_.size(); ++i) {
            if (!std::isfinite(plane_[i])) refuse(channel, i, plane_[i], "a finite number");
            store(i, plane_[i]);
        }
    }

    void read_depths(const VectorChannels& c, VectorFrame& out) {
        if (c.z) {
            read_plane(*c.z);
            for (std::size_t i = 0; i < plane_.size(); ++i) {
                const float z = plane_[i];
                if (!(z >= 0)) refuse(*c.z, i, z, "a depth of 0 or more");
                out.pixels[i].inverse_z = z == 0 || z >= background_z ? 0 : 1 / z;
            }
        } else {
            for (VectorPixel& p : out.pixels) {
                // Parallax: any growing function of the speed will do.
                const float speed = std::hypot(p.right_px, p.down_px);
                p.inverse_z = 1 + speed;
            }
        }
        if (!c.a) return;
        read_finite(*c.a, [&](std::size_t i, float a) {
            if (a == 0) out.pixels[i].inverse_z = 0;
        });
    }

    std::string name_;
    std::unique_ptr<OIIO::ImageInput> in_;
    std::vector<float> plane_;
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

bool is_openexr(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;
    std::ifstream in(path, std::ios::binary);
    char magic[4]{};
    return in.read(magic, 4) && magic[0] == 0x76 && magic[1] == 0x2f && magic[2] == 0x31 && magic[3] == 0x01;
}

VectorFrame read_vector_frame(const fs::path& path, const VectorChoice& choice) {
    return Reader(path).read(choice);
}

}  // namespace postlens
