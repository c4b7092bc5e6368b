#include "postlens/render.h"

#include <utility>

#include "postlens/internals.h"

namespace postlens::api {

RenderResult render(const std::filesystem::path& scene, const RenderSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"render"};
        words.add_file("scene", scene);
        words.add("--spp", std::optional(settings.spp));
        words.add(settings.lens);
        words.add("--size", settings.size);
        words.add("--camera", settings.camera);
        words.add("--time", settings.time_s);
        words.add("--shutter", settings.shutter);
        words.add("--shutter-curve", settings.shutter_curve);
        words.add("--sampler", settings.sampler);
        words.add("--seed", settings.seed);
        words.add_flag("--halves", settings.halves);
        words.add("--crop", settings.crop);
        words.add("--exposure", settings.exposure);
        words.add(settings.options);
        Outcome out = run_words(words);
        RenderResult result{.picture = out.take_picture(),
                            .halves = {},
                            .focal_length_mm = out.number("focal_length_mm"),
                            .f_number = out.number("f_number"),
                            .focus_distance_m = out.number("focus_m"),
                            .report = std::move(out.report)};
        for (std::size_t i = 1; i < out.result.pictures.size(); ++i)
            result.halves.push_back(picture_of(std::move(out.result.pictures[i])));
        return result;
    });
}

}  // namespace postlens::api
