#include "postlens/frame.h"

#include <utility>

#include "core/error.h"
#include "postlens/internals.h"
#include "records/sample_file.h"

namespace postlens::api {
namespace {

Damage damage_of(bool salvage) {
    return salvage ? Damage::salvage : Damage::refuse;
}

FrameInfo info_of(const std::filesystem::path& path, bool salvage) {
    Words words{"info"};
    words.add_file("frame", path);
    words.add_flag("--salvage", salvage);
    Outcome out = run_words(words);
    const nlohmann::ordered_json& json = out.result.json;
    FrameInfo info{.kind = out.text("kind"),
                   .width = static_cast<int>(out.count("width")),
                   .height = static_cast<int>(out.count("height")),
                   .records = out.count("records"),
                   .layers = static_cast<int>(out.count("layers")),
                   .overscan_px = static_cast<int>(out.count("overscan_px")),
                   .focal_length_mm = out.number_if_known("focal_length_mm"),
                   .film_distance_mm = out.number_if_known("film_distance_mm"),
                   .f_number = out.number_if_known("f_number"),
                   .focus_distance_m = out.number_if_known("focus_m"),
                   .exposure_stops = out.number_if_known("exposure_stops")};
    if (info.kind != "samples" && info.kind != "image") {
        fail(postlens::ExitCode::wrong_arguments,
             "{}: nothing to focus (got a {}; expected a sample file or a picture)", path.string(),
             info.kind);
    }
    if (info.kind == "samples") {
        info.instants_s.push_back(out.number("time_s"));
        for (const auto& time_s : json.at("key_times_s")) info.instants_s.push_back(time_s.get<double>());
        for (const auto& [id, name] : json.at("ids").items())
            info.ids.emplace(static_cast<std::uint32_t>(std::stoul(id)), name.get<std::string>());
    }
    info.report = std::move(out.report);
    return info;
}

Records columns_of(const RecordBand& band) {
    Records out{.x_begin = band.x_begin,
                .y_begin = band.y_begin,
                .columns = band.width(),
                .rows = band.height(),
                .offsets = band.offsets};
    const std::size_t count = band.records.size();
    for (auto* column : {&out.x, &out.y, &out.z, &out.w_bend}) column->reserve(count);
    for (auto* column : {&out.id, &out.path, &out.layer}) column->reserve(count);
    out.rgb.reserve(3 * count);
    out.w.reserve(4 * count);
    for (const Record& r : band.records) {
        out.x.push_back(r.x);
        out.y.push_back(r.y);
        out.z.push_back(r.z);
        out.rgb.insert(out.rgb.end(), {r.r, r.g, r.b});
        out.id.push_back(r.id);
        out.path.push_back(r.path.bits());
        out.layer.push_back(r.layer);
        out.w.insert(out.w.end(), {r.w.xx, r.w.xy, r.w.yx, r.w.yy});
        out.w_bend.push_back(r.w_bend);
    }
    return out;
}

}  // namespace

Frame::Frame(std::filesystem::path path, bool salvage) {
    guarded(nullptr, [&] {
        FrameInfo info = info_of(path, salvage);
        std::shared_ptr<KeptFrame> kept;
        if (info.kind == "samples") kept = std::make_shared<KeptFrame>(path.string(), damage_of(salvage));
        impl_ = std::make_shared<Impl>(Impl{std::move(path), salvage, std::move(info), std::move(kept)});
    });
}

const std::filesystem::path& Frame::path() const noexcept {
    return impl_->path;
}

const FrameInfo& Frame::info() const noexcept {
    return impl_->info;
}

Records Frame::records(std::size_t instant, Job* job) const {
    return guarded(job, [&] {
        if (!impl_->kept) {
            fail(postlens::ExitCode::wrong_arguments,
                 "{}: has no records (got a picture; expected a sample file)", impl_->path.string());
        }
        // With an exposure of 0 stops, the reader returns radiance unchanged.
        const SampleFileReader file(impl_->path, damage_of(impl_->salvage), 0.0);
        if (instant >= file.instants()) {
            fail(postlens::ExitCode::wrong_arguments,
                 "instant: the file has no such instant (got {}; expected 0 to {})", instant,
                 file.instants() - 1);
        }
        RecordBand band;
        file.read(file.y_begin(), file.y_end(), band, instant);
        return columns_of(band);
    });
}

}  // namespace postlens::api
