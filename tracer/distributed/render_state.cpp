#include "tracer/distributed/render_state.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <bit>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/checksum.h"
#include "core/error.h"
#include "core/files/output_file.h"
#include "core/memory.h"
#include "core/new_memory.h"
#include "pictures/exposure.h"
#include "pictures/exr/exr_attributes.h"
#include "pictures/exr/flat_exr.h"
#include "pictures/picture_part.h"

namespace postlens {
namespace {

constexpr const char* settings_attribute = "postlens:render";
constexpr const char* checksum_attribute = "postlens:checksum";
/// Name of the OpenEXR attribute that describes, as JSON, which sums of radiance the file holds per pixel.
constexpr const char* layout_attribute = "postlens:layout";

// Returns the number of 32-bit words that the file of an unfinished render stores for each pixel. The image
// has 3 words. Each independent half of the samples has 1 word for the number of samples, and 6 words (RGB
// doubles) for each sum of radiance.
std::size_t words_per_pixel(int halves, int blocks, bool with_open) {
    return 3 + static_cast<std::size_t>(halves) *
                   (1 + 6 * (static_cast<std::size_t>(blocks) + (with_open ? 1U : 0U)));
}

std::size_t words_per_pixel(const RenderState& s) {
    return words_per_pixel(s.halves, s.blocks, !s.open[0].empty());
}

/// Returns the OpenEXR channels in which an unfinished render is stored. There is one channel for each 32-bit
/// word of a pixel. `words` is the array of all pixels, and each channel gets a pointer to its word of the
/// first pixel. If `words` is null, the pointers are null.
std::vector<FlatExr::Channel> channels(const RenderState& s, const std::uint32_t* words) {
    std::vector<FlatExr::Channel> out;
    const auto add = [&](std::string name, ExrChannel::Type type) {
        out.push_back({std::move(name), type, words == nullptr ? nullptr : words + out.size()});
    };
    const auto add_sums = [&](const std::string& begin) {
        for (const char* colour : {"R", "G", "B"}) {
            add(begin + colour + ".low", ExrChannel::Type::uint32);
            add(begin + colour + ".high", ExrChannel::Type::uint32);
        }
    };
    for (const char* colour : {"R", "G", "B"}) add(colour, ExrChannel::Type::float32);
    for (int h = 0; h < s.halves; ++h) {
        const std::string half = fmt::format("half{}.", h);
        add(half + "samples", ExrChannel::Type::uint32);
        for (int b = 0; b < s.blocks; ++b)
            add_sums(s.blocks == 1 ? half : fmt::format("{}block{:02}.", half, b));
        if (!s.open[0].empty()) add_sums(half + "open.");
    }
    return out;
}

std::string text_of(const Imf::Header& header, const char* name) {
    const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
    return attribute == nullptr ? std::string() : attribute->value();
}

/// Calls `visit` with each value of a pixel's sums of radiance, in the order of the file's channels. The
/// samples of a pixel are summed in `blocks` blocks. If `open` is not empty, it holds the sum of an
/// incomplete block, which comes last.
template <typename State, typename Visit>
void each_sum(State& s, std::size_t half, std::size_t pixel, const Visit& visit) {
    const std::size_t values = 3 * s.samples[half].size();
    for (int b = 0; b < s.blocks; ++b) {
        for (std::size_t c = 0; c < 3; ++c)
            visit(s.sums[half][static_cast<std::size_t>(b) * values + 3 * pixel + c]);
    }
    if (s.open[half].empty()) return;
    for (std::size_t c = 0; c < 3; ++c) visit(s.open[half][3 * pixel + c]);
}

std::vector<std::uint32_t> pack(const RenderState& s) {
    Image picture = s.picture();
    set_exposure(picture, 0);
    const std::size_t pixels = s.samples[0].size();
    std::vector<std::uint32_t> out;
    out.reserve(pixels * words_per_pixel(s));
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            out.push_back(std::bit_cast<std::uint32_t>(picture.rgb[3 * i + c]));
        for (std::size_t h = 0; h < static_cast<std::size_t>(s.halves); ++h) {
            out.push_back(s.samples[h][i]);
            each_sum(s, h, i, [&](double sum) {
                const auto bits = std::bit_cast<std::uint64_t>(sum);
                out.push_back(static_cast<std::uint32_t>(bits));
                out.push_back(static_cast<std::uint32_t>(bits >> 32));
            });
        }
    }
    return out;
}

void unpack(const std::vector<std::uint32_t>& words, RenderState& s) {
    std::size_t at = 0;
    const std::size_t pixels = s.samples[0].size();
    for (std::size_t i = 0; i < pixels; ++i) {
        at += 3;
        for (std::size_t h = 0; h < static_cast<std::size_t>(s.halves); ++h) {
            s.samples[h][i] = words[at++];
            each_sum(s, h, i, [&](double& sum) {
                sum = std::bit_cast<double>(words[at] | (static_cast<std::uint64_t>(words[at + 1]) << 32));
                at += 2;
            });
        }
    }
}

std::string layout_text(const RenderState& s) {
    return nlohmann::ordered_json{{"halves", s.halves},
                                  {"blocks", s.blocks},
                                  {"open", !s.open[0].empty()},
                                  {"exposure_stops", s.exposure_stops}}
        .dump();
}

std::string checksum(const std::vector<std::uint32_t>& words) {
    return checksum_text(checksum_of(words.data(), words.size() * sizeof(std::uint32_t)));
}

}  // namespace

RenderState::RenderState(int w, int h, int count, double stops, int blocks_apart, bool with_open)
    : width(w), height(h), halves(count), blocks(blocks_apart), exposure_stops(stops) {
    const std::size_t pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        resize_by_all(sums[i], 3 * pixels * static_cast<std::size_t>(blocks));
        if (with_open) open[i].assign(3 * pixels, 0);
        samples[i].assign(pixels, 0);
    }
}

std::uint64_t RenderState::bytes(int width, int height, int halves, int blocks, bool with_open) {
    // Returns the memory that a render needs, in bytes. Each of the `halves` independent halves of the
    // samples has `sums` sums of radiance (24 bytes each) and a number of samples (4 bytes). A copy in the
    // layout of the file and two float images (24 bytes) are added.
    const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    const auto sums = static_cast<std::uint64_t>(blocks) + (with_open ? 1U : 0U);
    return pixels * ((24 * sums + 4) * static_cast<std::uint64_t>(halves) +
                     4 * words_per_pixel(halves, blocks, with_open) + 24);
}

void RenderState::add(const RenderState& part) {
    const std::size_t values = 3 * samples[0].size();
    for (std::size_t h = 0; h < static_cast<std::size_t>(halves); ++h) {
        for (std::size_t b = 0; b < static_cast<std::size_t>(part.blocks); ++b) {
            for (std::size_t i = 0; i < values; ++i) sums[h][i] += part.sums[h][b * values + i];
        }
        for (std::size_t i = 0; i < samples[h].size(); ++i) samples[h][i] += part.samples[h][i];
    }
}

namespace {

/// Returns the sum of a pixel's radiance in colour channel c over one of the two independent halves of its
/// samples. The partial sums of the pixel are added: those in `sums`, and the one in `open`.
double sum_of(const RenderState& s, std::size_t half, std::size_t pixel, std::size_t c) {
    const std::size_t values = 3 * s.samples[half].size();
    double sum = s.sums[half][3 * pixel + c];
    for (std::size_t b = 1; b < static_cast<std::size_t>(s.blocks); ++b)
        sum += s.sums[half][b * values + 3 * pixel + c];
    return s.open[half].empty() ? sum : sum + s.open[half][3 * pixel + c];
}

}  // namespace

Image RenderState::picture() const {
    Image out(width, height);
    out.exposure_stops = exposure_stops;
    for (std::size_t i = 0; i < samples[0].size(); ++i) {
        double count = samples[0][i];
        if (halves == 2) count += samples[1][i];
        if (count == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = sum_of(*this, 0, i, c);
            if (halves == 2) sum += sum_of(*this, 1, i, c);
            out.rgb[3 * i + c] = static_cast<float>(sum / count);
        }
    }
    return out;
}

Image RenderState::half(int which) const {
    Image out(width, height);
    out.exposure_stops = exposure_stops;
    const auto h = static_cast<std::size_t>(which);
    for (std::size_t i = 0; i < samples[h].size(); ++i) {
        if (samples[h][i] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            out.rgb[3 * i + c] = static_cast<float>(sum_of(*this, h, i, c) / samples[h][i]);
    }
    return out;
}

void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings,
                 const std::string& part_mark) {
    OutputFile file(path);
    const std::vector<std::uint32_t> words = pack(state);
    FlatExr exr;
    exr.display = exr.data = {0, 0, state.width - 1, state.height - 1};
    exr.channels = channels(state, words.data());
    exr.pixel_bytes = sizeof(std::uint32_t) * words_per_pixel(state);
    exr.row_bytes = exr.pixel_bytes * static_cast<std::size_t>(state.width);
    // Not compressed: the low bits of double-precision sums look random, so compression saves nothing.
    exr.compression = ChunkCompression::none;
    exr.texts = {{settings_attribute, settings}, {checksum_attribute, checksum(words)}};
    if (!part_mark.empty()) {
        exr.texts.emplace_back(samples_part_attribute, part_mark);
        exr.texts.emplace_back(layout_attribute, layout_text(state));
    }
    write_flat_exr(file.temporary_path(), path.string(), exr);
    file.commit();
}

namespace {

using Bad = std::function<void(const std::string& what)>;  ///< throws

std::unique_ptr<Imf::InputFile> opened(const std::filesystem::path& path, const Bad& bad) {
    try {
        check_exr_headers(path);
    } catch (const Error& e) {
        bad(e.what());
    }
    try {
        return std::make_unique<Imf::InputFile>(path.c_str());
    } catch (const std::exception&) {
        bad("it is no picture that an interrupted run left");
    }
    return nullptr;
}

void read_pixels(Imf::InputFile& in, const Bad& bad, RenderState& state) {
    const Imf::Header& header = in.header();
    if (header.dataWindow() != Imath::Box2i({0, 0}, {state.width - 1, state.height - 1}))
        bad("its size does not fit its settings");
    std::vector<std::uint32_t> words(words_per_pixel(state) * state.samples[0].size());
    const std::size_t pixel_bytes = sizeof(std::uint32_t) * words_per_pixel(state);
    Imf::FrameBuffer buffer;
    std::size_t at = 0;
    for (const FlatExr::Channel& wanted : channels(state, nullptr)) {
        const auto type = wanted.type == ExrChannel::Type::float32 ? Imf::FLOAT : Imf::UINT;
        const Imf::Channel* channel = header.channels().findChannel(wanted.name);
        if (channel == nullptr || channel->type != type || channel->xSampling != 1 || channel->ySampling != 1)
            bad("channels are missing");
        buffer.insert(wanted.name, Imf::Slice(type, reinterpret_cast<char*>(words.data() + at++), pixel_bytes,
                                              pixel_bytes * static_cast<std::size_t>(state.width)));
    }
    try {
        in.setFrameBuffer(buffer);
        in.readPixels(0, state.height - 1);
    } catch (const std::exception& e) {
        bad(fmt::format("damaged: {}", e.what()));
    }
    if (checksum(words) != text_of(header, checksum_attribute)) bad("damaged: its checksum is wrong");
    unpack(words, state);
}

// Returns the first setting that differs between two renders, with both values, for an error message.
// The arguments are JSON texts (RenderSetup::fingerprint).
std::string first_difference(const std::string& found, const std::string& expected) {
    const nlohmann::json got = nlohmann::json::parse(found, nullptr, false);
    const nlohmann::ordered_json wanted = nlohmann::ordered_json::parse(expected);
    for (const auto& [name, value] : wanted.items()) {
        const nlohmann::json other = got.is_object() ? got.value(name, nlohmann::json()) : nlohmann::json();
        if (other != nlohmann::json(value))
            return fmt::format("{} (got {}; expected {})", name, other.dump(), value.dump());
    }
    return "those of another version";
}

}  // namespace

void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state) {
    const Bad bad = [&](const std::string& what) {
        fail(ExitCode::invalid_input,
             "{}: cannot go on from this file: {} (without --resume it is made anew)", path.string(), what);
    };
    const std::unique_ptr<Imf::InputFile> in = opened(path, bad);
    const std::string found = text_of(in->header(), settings_attribute);
    if (found.empty()) bad("it is no picture that an interrupted run left");
    if (found != settings)
        bad(fmt::format("it was made with other settings: {}", first_difference(found, settings)));
    read_pixels(*in, bad, state);
}

std::optional<RenderPart> read_render_part(const std::filesystem::path& path, bool facts_only) {
    const Bad bad = [&](const std::string& what) {
        fail(ExitCode::invalid_input, "{}: is a damaged part ({})", path.string(), what);
    };
    const std::unique_ptr<Imf::InputFile> in = opened(path, bad);
    const Imf::Header& header = in->header();
    RenderPart out;
    out.settings = text_of(header, settings_attribute);
    out.mark = text_of(header, samples_part_attribute);
    if (out.settings.empty() || out.mark.empty()) return std::nullopt;
    const auto layout = nlohmann::ordered_json::parse(text_of(header, layout_attribute), nullptr, false);
    const auto number = [&](const char* name, int most) {
        if (!layout.is_object() || !layout.contains(name) || !layout[name].is_number_integer()) return 0;
        const auto value = layout[name].get<std::int64_t>();
        return value >= 1 && value <= most ? static_cast<int>(value) : 0;
    };
    const int halves = number("halves", 2), blocks = number("blocks", most_sample_blocks);
    if (halves == 0 || blocks == 0 || !layout.contains("open") || !layout["open"].is_boolean() ||
        !layout.contains("exposure_stops") || !layout["exposure_stops"].is_number())
        bad("its layout is not ours");
    const bool with_open = layout["open"].get<bool>();
    const Imath::Box2i& window = header.dataWindow();
    const auto width = static_cast<std::int64_t>(window.max.x) + 1,
               height = static_cast<std::int64_t>(window.max.y) + 1;
    // Rejects truncated files: the pixels are not compressed, so a complete file cannot be smaller than they
    // are.
    if (width < 1 || height < 1 || header.compression() != Imf::NO_COMPRESSION ||
        static_cast<double>(width) * static_cast<double>(height) * 4.0 *
                static_cast<double>(words_per_pixel(halves, blocks, with_open)) >
            static_cast<double>(std::filesystem::file_size(path)))
        bad("it is too short for its pixels");
    const int w = static_cast<int>(width), h = static_cast<int>(height);
    const double stops = layout["exposure_stops"].get<double>();
    if (facts_only) {
        out.state.width = w;
        out.state.height = h;
        out.state.halves = halves;
        out.state.exposure_stops = stops;
        return out;
    }
    require_memory(RenderState::bytes(w, h, halves, blocks, with_open), path.string() + ": the part");
    out.state = RenderState(w, h, halves, stops, blocks, with_open);
    read_pixels(*in, bad, out.state);
    return out;
}

}  // namespace postlens
