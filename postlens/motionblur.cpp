#include "postlens/motionblur.h"

#include <utility>

#include "postlens/internals.h"

namespace postlens::api {

MotionBlurResult motionblur(const Frame& frame, const MotionBlurSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"motionblur"};
        words.add(frame);
        words.add("--shutter", settings.shutter);
        words.add("--shutter-curve", settings.shutter_curve);
        words.add("--paths", settings.paths);
        words.add("--method", settings.method);
        words.add("--views", settings.views);
        words.add("--crop", settings.crop);
        words.add("--exposure", settings.exposure);
        words.add(settings.options);
        Outcome out = run_words(words, Internals::frame(frame).kept);
        return MotionBlurResult{.picture = out.take_picture(),
                                .method = out.text("method"),
                                .touched_share = out.number("touched_share"),
                                .report = std::move(out.report)};
    });
}

}  // namespace postlens::api
