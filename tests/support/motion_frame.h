// Traces a scene of SceneBuilder into a sample file and blurs it by its motion.
#pragma once

#include <cmath>
#include <filesystem>

#include "motionblur/motion_blur.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/trace.h"

namespace postlens::test {

/// The pixels per metre at a depth of 1 m, for 64 px on a film of 36 mm and a focal length of 50 mm.
inline constexpr double px_per_m = 50.0 / 36 * 64;

/// Keys of a translation by `to`, m, from 0 s to 1 s.
inline std::vector<TransformKey> from_to(const glm::dvec3& to) {
    return {{.time_s = 0}, {.time_s = 1, .translation = to}};
}

/// The peak signal-to-noise ratio of all colour values, dB, for a peak of 1.
inline double psnr(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double d = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
        sum += d * d;
    }
    return -10 * std::log10(sum / static_cast<double>(a.rgb.size()));
}

/// The sum of all red values.
inline double light_of(const Image& image) {
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) sum += static_cast<double>(image.rgb[i]);
    return sum;
}

/// A sample file of a scene, which is removed at the end.
class TracedFrame {
  public:
    explicit TracedFrame(const Scene& scene, TraceSettings settings = {}) {
        const std::filesystem::path path = folder_.path() / "frame.exr";
        trace_to_file(scene, settings, path);
        file_ = std::make_unique<SampleFileReader>(path);
    }
    [[nodiscard]] const SampleFileReader& file() const { return *file_; }
    [[nodiscard]] MotionBlurResult blur(MotionMethod method, double open_s = 0, double close_s = 1) const {
        return motion_blur(*file_, {.exposure = {open_s, close_s}, .method = method});
    }

  private:
    TemporaryFolder folder_;
    std::unique_ptr<SampleFileReader> file_;
};

/// Settings of a trace that records the surfaces which a shutter from 0 s to 1 s uncovers.
inline TraceSettings for_shutter(int levels = 2) {
    TraceSettings s;
    s.subdivision.levels = levels;
    s.for_shutter = TimeSpan{0, 1};
    s.overscan_px = 16;
    return s;
}

/// Whether the result has a warning of this code.
inline bool has_warning(const MotionBlurResult& r, const std::string& code) {
    for (const MotionWarning& w : r.warnings) {
        if (w.code == code) return true;
    }
    return false;
}

}  // namespace postlens::test
