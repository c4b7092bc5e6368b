#include "postlens/focus.h"

#include <utility>

#include "postlens/internals.h"
#include "postlens/shoot.h"

namespace postlens::api {
namespace {

FocusResult picture_through_lens(const Frame& frame, const Words& words) {
    Outcome out = run_words(words, Internals::frame(frame).kept);
    return {.picture = out.take_picture(),
            .method = out.text("method"),
            .focal_length_mm = out.number("focal_length_mm"),
            .f_number = out.number("f_number"),
            .focus_distance_m = out.number("focus_m"),
            .largest_coc_px = out.number_if_given("largest_coc_px"),
            .stated_db = out.number_if_given("stated_db"),
            .stated_low_db = out.number_if_given("stated_low_db"),
            .stated_high_db = out.number_if_given("stated_high_db"),
            .report = std::move(out.report)};
}

}  // namespace

FocusResult focus(const Frame& frame, const FocusSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"focus"};
        words.add(frame);
        words.add(settings.lens);
        words.add("--method", settings.method);
        words.add("--views", settings.views);
        words.add("--depths", settings.depths);
        words.add("--target-db", settings.target_db);
        words.add("--scene", settings.scene);
        words.add("--crop", settings.crop);
        words.add("--exposure", settings.exposure);
        words.add_list("--passes", settings.passes);
        words.add(settings.options);
        return picture_through_lens(frame, words);
    });
}

FocusResult shoot(const Frame& frame, const ShootSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"shoot"};
        words.add(frame);
        words.add(settings.lens);
        words.add("--shutter", settings.shutter);
        words.add("--shutter-curve", settings.shutter_curve);
        words.add("--paths", settings.paths);
        words.add("--method", settings.method);
        words.add("--views", settings.views);
        words.add("--target-db", settings.target_db);
        words.add("--scene", settings.scene);
        words.add("--crop", settings.crop);
        words.add("--exposure", settings.exposure);
        words.add(settings.options);
        return picture_through_lens(frame, words);
    });
}

}  // namespace postlens::api
