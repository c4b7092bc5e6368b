#include "scene/gltf/image_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/text.h"
#include "pictures/formats/picture_library.h"
#include "pictures/formats/plain_picture.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

// Returns the file format by its first bytes. The format that a scene states may be wrong.
const char* format_of(std::string_view bytes) {
    using namespace std::string_view_literals;
    struct Magic {
        std::string_view bytes;
        const char* format;
    };
    constexpr std::array<Magic, 3> known{
        {{"\x89PNG"sv, "png"}, {"\xFF\xD8\xFF"sv, "jpeg"}, {"\x76\x2F\x31\x01"sv, "openexr"}}};
    for (const Magic& m : known) {
        if (bytes.starts_with(m.bytes)) return m.format;
    }
    return nullptr;
}

[[noreturn]] void fail_undecoded(const std::string& name, const std::string& problem) {
    constexpr std::size_t longest = 200;
    fail(ExitCode::invalid_input, "{}: cannot be decoded ({})", name, printable(problem.substr(0, longest)));
}

}  // namespace

RawImage decode_image(std::string_view bytes, const std::string& name) {
    const char* format = format_of(bytes);
    if (!format) fail(ExitCode::invalid_input, "{}: is no PNG, JPEG or OpenEXR picture", name);
    std::string problem;
    auto in = open_plain_png(bytes);
    if (!in) in = picture_library().open(bytes, format, problem);
    if (!in) fail_undecoded(name, problem);
    const PictureLayout& layout = in->layout();
    const double pixels = static_cast<double>(layout.width) * layout.height;
    if (layout.width < 1 || layout.height < 1 || pixels > most_image_pixels || layout.channels.empty() ||
        layout.deep) {
        fail(ExitCode::invalid_input, "{}: is too large (got {}x{} px; expected at most {} px)", name,
             layout.width, layout.height, most_image_pixels);
    }
    const std::size_t channels = std::min<std::size_t>(layout.channels.size(), 4);
    RawImage out;
    out.width = layout.width;
    out.height = layout.height;
    const auto count = static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height);
    std::vector<float> read(count * channels);
    problem = in->read(static_cast<int>(channels), read.data());
    if (!problem.empty()) fail_undecoded(name, problem);
    const bool grey = channels < 3;
    out.has_alpha = channels == 2 || channels == 4;
    out.rgba.resize(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const float* from = read.data() + i * channels;
        float* to = out.rgba.data() + 4 * i;
        for (int k = 0; k < 3; ++k) to[k] = from[grey ? 0 : k];
        to[3] = out.has_alpha ? from[channels - 1] : 1.0F;
    }
    if (std::any_of(out.rgba.begin(), out.rgba.end(), [](float v) { return !std::isfinite(v); })) {
        fail(ExitCode::invalid_input, "{}: has pixels that are not finite", name);
    }
    return out;
}

ImageTexture colour_image(const RawImage& raw) {
    ImageTexture out;
    out.width = raw.width;
    out.height = raw.height;
    out.rgb.resize(raw.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < raw.rgba.size() / 4; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            out.rgb[3 * i + k] = linear_from_srgb(std::max(raw.rgba[4 * i + k], 0.0F));
        }
    }
    return out;
}

glm::dvec3 mean_colour(const RawImage& raw) {
    const ImageTexture linear = colour_image(raw);
    glm::dvec3 sum(0);
    for (std::size_t i = 0; i < linear.rgb.size(); i += 3) {
        sum += glm::dvec3(linear.rgb[i], linear.rgb[i + 1], linear.rgb[i + 2]);
    }
    return sum / (static_cast<double>(linear.rgb.size()) / 3);
}

double channel_mean(const RawImage& raw, std::size_t channel) {
    double sum = 0;
    for (std::size_t i = channel; i < raw.rgba.size(); i += 4) sum += static_cast<double>(raw.rgba[i]);
    return sum / (static_cast<double>(raw.rgba.size()) / 4);
}

}  // namespace postlens
