#include "postlens/trace.h"

#include <utility>

#include "postlens/internals.h"

namespace postlens::api {

TraceResult trace(const std::filesystem::path& scene, const std::filesystem::path& output,
                  const TraceSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"trace"};
        words.add_file("scene", scene);
        words.add("--output", output);
        words.add("--size", settings.size);
        words.add("--camera", settings.camera);
        words.add("--time", settings.time_s);
        words.add("--for-f-number", settings.for_f_number);
        words.add("--for-focus", settings.for_focus_distance_m);
        words.add("--for-shutter", settings.for_shutter);
        words.add_flag("--for-rays", settings.for_rays);
        words.add("--subdivide", settings.subdivide);
        words.add("--threshold", settings.threshold);
        words.add_count("--hidden-layers", settings.hidden_layers);
        words.add_count("--overscan", settings.overscan_px);
        words.add_count("--keys", settings.keys);
        words.add("--exposure", settings.exposure);
        words.add(settings.options);
        Outcome out = run_words(words);
        TraceResult result{.records = out.count("records"),
                           .bytes = out.count("bytes"),
                           .overscan_px = static_cast<int>(out.count("overscan_px"))};
        if (const auto rays = out.result.json.find("rays"); rays != out.result.json.end())
            result.eye_rays = rays->value("eye", std::uint64_t{0});
        result.report = std::move(out.report);
        return result;
    });
}

}  // namespace postlens::api
