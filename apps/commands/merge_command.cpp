#include <filesystem>
#include <map>

#include "apps/command.h"
#include "apps/commands/merge_parts.h"
#include "apps/deliver.h"
#include "apps/share.h"
#include "core/counted.h"
#include "core/memory.h"
#include "pictures/picture_part.h"
#include "tracer/distributed/render_state.h"
#include "tracer/render.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

struct NamedPart {
    std::string name;
    PicturePart part;
    Json mark;
    Share share;
    std::optional<double> exposure_stops;
};

NamedPart read_part(const std::string& name) {
    std::optional<PicturePart> part = read_picture_part(name);
    if (!part) {
        fail(ExitCode::invalid_input, "{}: is no part (expected an OpenEXR file that --share has written)",
             name);
    }
    NamedPart out{name, std::move(*part), {}, {}, {}};
    out.exposure_stops = out.part.image.exposure_stops;
    out.mark = Json::parse(out.part.mark, nullptr, false);
    out.share = share_in(out.mark, name);
    return out;
}

std::optional<Crop> crop_in(const Json& mark) {
    const Json& c = mark["crop"];
    if (c.is_null()) return {};  // share_in has checked the rest
    return Crop{c[0].get<int>(), c[1].get<int>(), c[2].get<int>(), c[3].get<int>()};
}

struct Merged {  // NOLINT(bugprone-exception-escape): as PartFacts, which it holds
    Image image;
    std::vector<Image> halves;
    PartFacts first;
    std::vector<int> missing;
};

/// Returns a black image of the size of the whole image. `part` is the part of this image that one machine
/// computed. The black image has the same channels and exposure as `part`.
Image whole_of(const NamedPart& part) {
    const ImageSize& size = part.part.whole;
    require_memory(static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height) *
                       sizeof(float) * (4 + part.part.image.planes.size()),
                   "the merged picture");
    Image out(size.width, size.height);
    out.exposure_stops = part.exposure_stops;
    const std::size_t pixels = out.rgb.size() / 3;
    if (!part.part.image.alpha.empty()) out.alpha.resize(pixels);
    for (const Image::Plane& p : part.part.image.planes)
        out.planes.push_back({p.name, std::vector<float>(pixels)});
    out.texts = part.part.image.texts;
    return out;
}

/// Joins the files of an image that was divided by rows. Only one file at a time is in memory.
Merged merge_rows(const std::vector<std::string>& names, bool partial) {
    Merged out;
    FoundParts found;
    ImageSize size;
    std::optional<double> stops;
    for (const std::string& name : names) {
        const NamedPart part = read_part(name);
        const PartFacts facts{name, part.mark, part.share};
        if (out.first.name.empty()) {
            out.first = facts;
            size = part.part.whole;
            stops = part.exposure_stops;
            out.image = whole_of(part);
        }
        check_same_work(out.first, facts);
        found.add(facts);
        if (part.part.whole != size || part.exposure_stops != stops) {
            fail(ExitCode::invalid_input, "{}: has another size or exposure than {}", name, out.first.name);
        }
        if (part.part.place != rows_of_share(part.share, crop_in(part.mark), size.width, size.height)) {
            fail(ExitCode::invalid_input, "{}: is a damaged part (its rows are not those of share {}/{})",
                 name, part.share.index, part.share.count);
        }
        paste(part.part, name, out.image);
    }
    out.missing = found.missing(out.first.share.count, partial);
    return out;
}

/// Joins the result files `names` of several machines, each of which computed some samples of every pixel.
/// The samples are added up. Only one file at a time is in memory, because each is as large as the whole
/// image.
Merged merge_samples(const std::vector<std::string>& names, bool partial) {
    Merged out;
    FoundParts found;
    std::map<int, std::string> ordered;
    const auto read = [](const std::string& name, bool facts_only) {
        std::optional<RenderPart> part = read_render_part(name, facts_only);
        if (!part) {
            fail(ExitCode::invalid_input,
                 "{}: is no part of a render's samples (expected what --share-by samples "
                 "has written)",
                 name);
        }
        return *std::move(part);
    };
    RenderState sum;
    for (const std::string& name : names) {
        const RenderPart part = read(name, true);
        PartFacts facts{name, Json::parse(part.mark, nullptr, false), {}};
        facts.share = share_in(facts.mark, name);
        if (out.first.name.empty()) {
            out.first = facts;
            sum = RenderState(part.state.width, part.state.height, part.state.halves,
                              part.state.exposure_stops);
        }
        check_same_work(out.first, facts);
        found.add(facts);
        if (part.state.width != sum.width || part.state.height != sum.height ||
            part.state.halves != sum.halves || part.state.exposure_stops != sum.exposure_stops)
            fail(ExitCode::invalid_input, "{}: has another size or exposure than {}", name, out.first.name);
        ordered[facts.share.index] = name;
    }
    out.missing = found.missing(out.first.share.count, partial);
    for (const auto& [index, name] : ordered) sum.add(read(name, false).state);
    out.image = sum.picture();
    if (sum.halves == 2) out.halves = {sum.half(0), sum.half(1)};
    return out;
}

/// Joins the results of a `render --halves` that was divided by rows. Each part has two files, one for each
/// half of the samples. So the result is two images.
std::vector<Image> merge_halves(const std::vector<std::string>& names, bool partial) {
    std::vector<Image> out;
    for (std::size_t h = 0; h < 2; ++h) {
        std::vector<std::string> parts;
        parts.reserve(names.size());
        for (const std::string& name : names) parts.push_back(half_paths(name)[h].string());
        out.push_back(merge_rows(parts, partial).image);
    }
    return out;
}

CommandResult merge_pictures(const MergeOptions& options) {
    check_output(options.output);
    const bool samples =
        is_openexr(options.parts.front()) && read_render_part(options.parts.front(), true).has_value();
    Merged merged =
        samples ? merge_samples(options.parts, options.partial) : merge_rows(options.parts, options.partial);
    const Json& made_by = merged.first.mark["made_by"];
    if (!samples && made_by["command"] == "render" && made_by.contains("--halves"))
        merged.halves = merge_halves(options.parts, options.partial);
    const int count = merged.first.share.count;
    CommandResult out;
    out.json = {
        {"parts", options.parts.size()}, {"of", count}, {"missing", merged.missing}, {"made_by", made_by}};
    out.text = fmt::format("{}: {}x{} px from {} of {}", options.output, merged.image.width,
                           merged.image.height, options.parts.size(), counted(count, "part"));
    if (!merged.missing.empty()) {
        out.warnings.push_back({"partial",
                                fmt::format("parts are missing, their {}: {}",
                                            samples ? "samples are not in the mean" : "rows are black",
                                            listed(merged.missing, count)),
                                static_cast<double>(merged.missing.size()) / count});
    }
    const std::optional<Crop> crop = crop_in(merged.first.mark);
    if (!merged.halves.empty()) {
        const auto results = half_paths(options.output);
        for (std::size_t h = 0; h < results.size(); ++h) write_image(results[h], merged.halves[h], crop);
        out.json["halves"] = {results[0].string(), results[1].string()};
    }
    deliver(std::move(merged.image), {options.output, crop, {}, {}}, out);
    return out;
}

}  // namespace

CommandResult run_merge(const MergeOptions& options) {
    const std::string& first = options.parts.front();
    if (std::filesystem::path(first).extension() == ".json") return merge_items(options);
    if (SampleFileReader::is_sample_file(first)) return merge_traces(options);
    return merge_pictures(options);
}

}  // namespace postlens
