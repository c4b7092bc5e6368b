#include "tracer/render_state.h"

#include <OpenImageIO/imageio.h>
#include <bit>
#include <cstring>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/error.h"
#include "core/output_file.h"
#include "records/exr_attributes.h"

namespace postlens {
namespace {

constexpr const char* settings_attribute = "postlens:render";
constexpr const char* checksum_attribute = "postlens:checksum";

// One 32-bit word per channel: three floats, then per half a count and the two words of three doubles.
std::size_t words_per_pixel(int halves) {
    return 3 + 7 * static_cast<std::size_t>(halves);
}

OIIO::ImageSpec layout(int width, int height, int halves) {
    OIIO::ImageSpec spec(width, height, static_cast<int>(words_per_pixel(halves)), OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B"};
    spec.channelformats.assign(3, OIIO::TypeDesc::FLOAT);
    for (int h = 0; h < halves; ++h) {
        const std::string half = fmt::format("half{}.", h);
        spec.channelnames.push_back(half + "samples");
        for (const char* colour : {"R", "G", "B"}) {
            spec.channelnames.push_back(half + colour + ".low");
            spec.channelnames.push_back(half + colour + ".high");
        }
    }
    spec.channelformats.resize(spec.channelnames.size(), OIIO::TypeDesc::UINT);
    return spec;
}

std::vector<std::uint32_t> pack(const RenderState& s) {
    const Image picture = s.picture();
    const std::size_t pixels = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height);
    std::vector<std::uint32_t> out;
    out.reserve(pixels * words_per_pixel(s.halves));
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            out.push_back(std::bit_cast<std::uint32_t>(picture.rgb[3 * i + c]));
        for (std::size_t h = 0; h < static_cast<std::size_t>(s.halves); ++h) {
            out.push_back(s.samples[h][i]);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto bits = std::bit_cast<std::uint64_t>(s.sums[h][3 * i + c]);
                out.push_back(static_cast<std::uint32_t>(bits));
                out.push_back(static_cast<std::uint32_t>(bits >> 32));
            }
        }
    }
    return out;
}

void unpack(const std::vector<std::uint32_t>& words, RenderState& s) {
    std::size_t at = 0;
    const std::size_t pixels = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height);
    for (std::size_t i = 0; i < pixels; ++i) {
        at += 3;
        for (std::size_t h = 0; h < static_cast<std::size_t>(s.halves); ++h) {
            s.samples[h][i] = words[at++];
            for (std::size_t c = 0; c < 3; ++c, at += 2) {
                s.sums[h][3 * i + c] =
                    std::bit_cast<double>(words[at] | (static_cast<std::uint64_t>(words[at + 1]) << 32));
            }
        }
    }
}

std::string checksum(const std::vector<std::uint32_t>& words) {
    return fmt::format("{:016x}", XXH3_64bits(words.data(), words.size() * sizeof(std::uint32_t)));
}

}  // namespace

RenderState::RenderState(int w, int h, int count) : width(w), height(h), halves(count) {
    const std::size_t pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        sums[i].assign(3 * pixels, 0);
        samples[i].assign(pixels, 0);
    }
}

std::uint64_t RenderState::bytes(int width, int height, int halves) {
    // The sums, the words of a file of them and two pictures.
    const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    return pixels * (28 * static_cast<std::uint64_t>(halves) + 4 * words_per_pixel(halves) + 24);
}

Image RenderState::picture() const {
    Image out(width, height);
    for (std::size_t i = 0; i < samples[0].size(); ++i) {
        double count = samples[0][i];
        if (halves == 2) count += samples[1][i];
        if (count == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = sums[0][3 * i + c];
            if (halves == 2) sum += sums[1][3 * i + c];
            out.rgb[3 * i + c] = static_cast<float>(sum / count);
        }
    }
    return out;
}

Image RenderState::half(int which) const {
    Image out(width, height);
    const auto h = static_cast<std::size_t>(which);
    for (std::size_t i = 0; i < samples[h].size(); ++i) {
        if (samples[h][i] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            out.rgb[3 * i + c] = static_cast<float>(sums[h][3 * i + c] / samples[h][i]);
    }
    return out;
}

void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings) {
    OutputFile file(path);
    OIIO::ImageSpec spec = layout(state.width, state.height, state.halves);
    const std::vector<std::uint32_t> words = pack(state);
    spec.attribute("compression", "none");  // sums are noise to any compression
    spec.attribute(settings_attribute, settings);
    spec.attribute(checksum_attribute, checksum(words));
    auto out = OIIO::ImageOutput::create("exr");
    if (!out || !out->open(file.temporary_path().string(), spec) ||
        !out->write_image(OIIO::TypeDesc::UNKNOWN, words.data()) || !out->close()) {
        fail(ExitCode::cannot_write, "{}: cannot write: {}", path.string(),
             out ? out->geterror() : OIIO::geterror());
    }
    file.commit();
}

void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state) {
    const auto bad = [&](const std::string& what) {
        fail(ExitCode::invalid_input,
             "{}: cannot go on from this file: {} (without --resume it is made anew)", path.string(), what);
    };
    try {
        check_exr_headers(path);
    } catch (const Error& e) {
        bad(e.what());
    }
    auto in = OIIO::ImageInput::open(path.string());
    if (!in) {
        OIIO::geterror();
        bad("it is no picture that an interrupted run left");
    }
    const OIIO::ImageSpec& spec = in->spec();
    const OIIO::ImageSpec wanted = layout(state.width, state.height, state.halves);
    const std::string found = spec.get_string_attribute(settings_attribute);
    if (found.empty()) bad("it is no picture that an interrupted run left");
    if (found != settings) bad(fmt::format("other settings (got {}; expected {})", found, settings));
    if (spec.width != wanted.width || spec.height != wanted.height || spec.nchannels != wanted.nchannels)
        bad("its size does not fit its settings");
    // Readers may order channels by their own taste.
    std::vector<std::size_t> channel;
    for (std::size_t i = 0; i < wanted.channelnames.size(); ++i) {
        const int at = spec.channelindex(wanted.channelnames[i]);
        if (at < 0 || spec.channelformat(at) != wanted.channelformats[i]) bad("channels are missing");
        channel.push_back(static_cast<std::size_t>(at));
    }
    const std::size_t n = channel.size();
    std::vector<std::uint32_t> row(n * static_cast<std::size_t>(state.width)), words;
    words.reserve(row.size() * static_cast<std::size_t>(state.height));
    for (int y = 0; y < state.height; ++y) {
        if (!in->read_scanline(y, 0, OIIO::TypeDesc::UNKNOWN, row.data())) {
            bad(fmt::format("damaged: {}", in->geterror()));
        }
        for (std::size_t x = 0; x < static_cast<std::size_t>(state.width); ++x) {
            for (const std::size_t c : channel) words.push_back(row[x * n + c]);
        }
    }
    if (checksum(words) != spec.get_string_attribute(checksum_attribute))
        bad("damaged: its checksum is wrong");
    unpack(words, state);
}

}  // namespace postlens
