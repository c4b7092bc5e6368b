#include "postlens/sweep.h"

#include <limits>
#include <utility>

#include "postlens/internals.h"

namespace postlens::api {
namespace {

SweepPicture picture_of_row(const nlohmann::ordered_json& row) {
    const auto number = [&row](const char* key) {
        const auto& value = row.at(key);
        return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
    };
    SweepPicture out{.file = row.at("file").get<std::string>(),
                     .focal_length_mm = number("focal_length_mm"),
                     .f_number = number("f_number"),
                     .focus_distance_m = number("focus_m"),
                     .impulse = row.at("impulse").get<std::string>(),
                     .method = row.at("method").get<std::string>(),
                     .largest_coc_px = number("largest_coc_px"),
                     .in_focus_share = number("in_focus_share")};
    if (!row.at("shutter_open_s").is_null())
        out.shutter = Shutter{.open_s = number("shutter_open_s"), .close_s = number("shutter_close_s")};
    return out;
}

}  // namespace

SweepResult sweep(const std::filesystem::path& frame, const std::filesystem::path& output,
                  const SweepSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"sweep"};
        words.add_file("frame", frame);
        words.add("--output", output);
        words.add_list("--f-number", settings.f_number);
        words.add_list("--focal-length", settings.focal_length_mm);
        words.add_list("--focus", settings.focus_distance_m);
        words.add_list("--shutter", settings.shutter);
        words.add_list("--impulse", settings.impulse);
        words.add("--method", settings.method);
        words.add("--views", settings.views);
        words.add("--format", settings.format);
        words.add_flag("--resume", settings.resume);
        words.add("--exposure", settings.exposure);
        words.add(settings.options);
        Outcome out = run_words(words);
        SweepResult result{.made = static_cast<int>(out.count("made")),
                           .kept = static_cast<int>(out.count("kept"))};
        if (out.result.json.contains("pictures")) {
            for (const auto& row : out.result.json["pictures"])
                result.pictures.push_back(picture_of_row(row));
        }
        result.report = std::move(out.report);
        return result;
    });
}

}  // namespace postlens::api
