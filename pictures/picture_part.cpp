#include "pictures/picture_part.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/checksum.h"
#include "core/error.h"
#include "core/memory.h"
#include "pictures/crop.h"
#include "pictures/exr/exr_attributes.h"
#include "pictures/exr/exr_input.h"
#include "pictures/foreign/foreign_file.h"

namespace postlens {
namespace {

constexpr const char* part_attribute = "postlens.part";
constexpr const char* checksum_key = "checksum";
constexpr const char* exposure_key = "exposure_stops";
constexpr int most_side_px = 1 << 20;

/// Returns a checksum of all values of an image, in their order in memory.
std::string checksum(const Image& image) {
    Checksum sum;
    const auto add = [&](const std::vector<float>& values) {
        sum.add(values.data(), values.size() * sizeof(float));
    };
    add(image.rgb);
    add(image.alpha);
    for (const Image::Plane& p : image.planes) {
        sum.add(p.name.data(), p.name.size());
        add(p.values);
    }
    return checksum_text(sum.value());
}

bool same_channels(const Image& a, const Image& b) {
    return a.alpha.empty() == b.alpha.empty() &&
           std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), b.planes.end(),
                      [](const Image::Plane& p, const Image::Plane& q) { return p.name == q.name; });
}

}  // namespace

void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(mark);
    json[exposure_key] = image.exposure_stops ? nlohmann::ordered_json(*image.exposure_stops) : nullptr;
    std::sort(image.planes.begin(), image.planes.end(), [](const Image::Plane& a, const Image::Plane& b) {
        return a.name < b.name;
    });  // OpenEXR stores channels in the order of their names
    json[checksum_key] = checksum(cut(image, crop));
    image.texts.emplace_back(part_attribute, json.dump());
    image.exposure_stops = 0.0;
}

std::optional<PicturePart> read_picture_part(const std::filesystem::path& path) {
    check_exr_headers(path);
    const auto bad = [&](const std::string& what) {
        fail(ExitCode::invalid_input, "{}: is a damaged part ({})", path.string(), what);
    };
    if (!is_openexr(path)) return std::nullopt;
    PicturePart out;
    try {
        Imf::InputFile file(path.c_str());
        const Imf::Header& header = file.header();
        const auto* mark = header.findTypedAttribute<Imf::StringAttribute>(part_attribute);
        if (mark == nullptr) return std::nullopt;
        const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
        if (display.min.x != 0 || display.min.y != 0 || data.min.x < 0 || data.min.y < 0 ||
            data.max.x > display.max.x || data.max.y > display.max.y || display.max.x >= most_side_px ||
            display.max.y >= most_side_px)
            bad("its windows do not fit");
        out.whole = {display.max.x + 1, display.max.y + 1};
        out.place = {data.min.x, data.min.y, data.max.x - data.min.x + 1, data.max.y - data.min.y + 1};
        const auto pixels =
            static_cast<std::uint64_t>(out.place.width) * static_cast<std::uint64_t>(out.place.height);
        // The file is not compressed, so it must be at least as large as its pixels.
        if (header.compression() != Imf::NO_COMPRESSION ||
            pixels * 3 * sizeof(float) > std::filesystem::file_size(path))
            bad("it is too short for its pixels");
        out.image = Image(out.place.width, out.place.height);
        Imf::FrameBuffer buffer;
        const auto slice = [&](const std::string& name, float* first, std::size_t step) {
            const auto row = step * static_cast<std::size_t>(out.place.width);
            float* origin = first - static_cast<std::ptrdiff_t>(step) * out.place.x -
                            static_cast<std::ptrdiff_t>(row) * out.place.y;
            buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(origin), step * sizeof(float),
                                           row * sizeof(float)));
        };
        std::vector<std::string> names;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
            const std::string name = c.name();
            if (name == "A" && c.channel().type == Imf::HALF) continue;  // 1 everywhere
            if (c.channel().type != Imf::FLOAT || c.channel().xSampling != 1 || c.channel().ySampling != 1)
                bad("channel " + name + " is of another type");
            if (name != "R" && name != "G" && name != "B" && name != "A") names.push_back(name);
        }
        require_memory(pixels * sizeof(float) * (names.size() + 1), path.string() + ": the part");
        for (std::size_t i = 0; i < 3; ++i) slice(std::string(1, "RGB"[i]), out.image.rgb.data() + i, 3);
        if (header.channels().findChannel("A") != nullptr &&
            header.channels().findChannel("A")->type == Imf::FLOAT) {
            out.image.alpha.resize(pixels);
            slice("A", out.image.alpha.data(), 1);
        }
        for (const std::string& name : names) out.image.planes.push_back({name, std::vector<float>(pixels)});
        for (Image::Plane& p : out.image.planes) slice(p.name, p.values.data(), 1);
        file.setFrameBuffer(buffer);
        file.readPixels(data.min.y, data.max.y);
        for (auto a = header.begin(); a != header.end(); ++a) {
            const std::string name = a.name();
            const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
            if (text != nullptr && name.rfind("cryptomatte/", 0) == 0)
                out.image.texts.emplace_back(name, text->value());
        }
        out.mark = mark->value();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        bad(e.what());
    }
    const auto json = nlohmann::ordered_json::parse(out.mark, nullptr, false);
    if (!json.is_object() || !json.contains(checksum_key) || !json.contains(exposure_key))
        bad("its mark is not ours");
    if (json[checksum_key] != checksum(out.image)) bad("its pixels are not those that were written");
    out.image.exposure_stops.reset();
    if (json[exposure_key].is_number()) out.image.exposure_stops = json[exposure_key].get<double>();
    return out;
}

std::string read_part_mark(const std::filesystem::path& path) {
    const ExrHeaders headers = read_exr_headers(InputFile(path), 1);
    const ExrPart& first = headers.parts.front();
    if (auto mark = first.get_string(part_attribute)) return *std::move(mark);
    return first.get_string(samples_part_attribute).value_or("");
}

void paste(const PicturePart& part, const std::string& name, Image& whole) {
    if (!same_channels(part.image, whole))
        fail(ExitCode::invalid_input, "{}: has other channels than the first part", name);
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to, std::size_t step) {
        for (int y = 0; y < part.place.height; ++y) {
            const std::size_t at =
                (static_cast<std::size_t>(part.place.y + y) * static_cast<std::size_t>(whole.width) +
                 static_cast<std::size_t>(part.place.x)) *
                step;
            const std::size_t row = static_cast<std::size_t>(part.place.width) * step;
            std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * row), row,
                        to.begin() + static_cast<std::ptrdiff_t>(at));
        }
    };
    copy(part.image.rgb, whole.rgb, 3);
    if (!whole.alpha.empty()) copy(part.image.alpha, whole.alpha, 1);
    for (std::size_t i = 0; i < whole.planes.size(); ++i)
        copy(part.image.planes[i].values, whole.planes[i].values, 1);
}

}  // namespace postlens
