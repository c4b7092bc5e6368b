// Measures how well the hybrid detects view samples that the records do not determine (unsure ones): the
// share that it replaces by rays, and the error of the others. Prints shares and errors; writes maps.
//
//   unsure_views FRAME SCENE F_NUMBER VIEWS [MAPS]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <string>

#include "pictures/image.h"
#include "pictures/srgb.h"
#include "planner/hybrid.h"
#include "records/sample_file.h"
#include "scene/scene.h"

namespace {

using namespace postlens;

double encoded(double linear) {
    return static_cast<double>(srgb_from_linear(static_cast<float>(linear)));
}

void measure(const std::string& frame, const std::string& scene_path, double f_number, int views,
             const std::string& maps) {
    const SampleFileReader file(frame);
    const SampleHeader& h = file.header();
    const Scene scene = read_scene(scene_path);
    HybridSettings settings;
    settings.focus.lens = {h.focal_length_mm, f_number};
    settings.focus.focus_distance_m = h.focus_m.value_or(5);
    settings.focus.views = views;
    settings.scene = &scene;
    settings.checked = [&](int, int, std::vector<std::uint32_t>& out) {
        for (int v = 0; v < views / 2; ++v) out.push_back(static_cast<std::uint32_t>(v));
    };
    const HybridResult result = hybrid_picture(file, settings);
    Image traced(h.width, h.height), wrong(h.width, h.height);
    double error = 0;
    std::vector<double> errors;
    for (int y = 0; y < h.height; ++y) {
        for (int x = 0; x < h.width; ++x) {
            const auto k =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width) + static_cast<std::size_t>(x);
            const PixelCheck& c = result.checks[k];
            const float* rgb = result.focus.image.pixel(x, y);
            double of_pixel = 0;
            for (std::size_t n = 0; n < 3; ++n) {
                const double off = c.mean(n);
                const double here = encoded(static_cast<double>(rgb[n])),
                             right = encoded(static_cast<double>(rgb[n]) + off);
                of_pixel += (right - here) * (right - here) / 3;
            }
            errors.push_back(of_pixel);
            error += of_pixel;
            for (int n = 0; n < 3; ++n) {
                traced.pixel(x, y)[n] = result.traced[k];
                wrong.pixel(x, y)[n] = static_cast<float>(std::min(1.0, 100 * of_pixel));
            }
        }
    }
    const auto pixels = static_cast<double>(errors.size());
    std::sort(errors.begin(), errors.end(), std::greater<>());
    double worst = 0;
    for (std::size_t i = 0; i < errors.size() / 100; ++i) worst += errors[i];
    fmt::print("traced {:.2f} %, sure but wrong {:.2f} dB, of which the worst 1 % of the pixels {:.1f} %\n",
               100 * result.retraced_share, -10 * std::log10(error / pixels), 100 * worst / error);
    if (maps.empty()) return;
    write_image(maps + "_traced.png", traced);
    write_image(maps + "_wrong.png", wrong);
    write_image(maps + "_picture.png", result.focus.image);
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 5) {
        fmt::print(stderr, "expected FRAME SCENE F_NUMBER VIEWS [MAPS]\n");
        return 2;
    }
    measure(argv[1], argv[2], std::stod(argv[3]), std::stoi(argv[4]), argc > 5 ? argv[5] : "");
    return 0;
} catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
}
