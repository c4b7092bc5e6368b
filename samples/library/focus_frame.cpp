// A program of one's own on top of postlens: the picture of a sample file through 50 mm at f/2, focused at 3
// m.
#include <cstdio>

#include "core/error.h"
#include "focus/focus.h"

int main(int argc, char** argv) try {
    if (argc != 3) return std::fprintf(stderr, "usage: focus_frame FRAME.exr IMAGE\n"), 2;
    const postlens::SampleFileReader file(argv[1]);
    const postlens::FocusResult result = postlens::focus_picture(
        file, {.lens = {.focal_length_mm = 50, .f_number = 2}, .focus_distance_m = 3});
    postlens::write_image(argv[2], result.image);
    std::printf("%dx%d px, widest circle of confusion %.1f px\n", result.image.width, result.image.height,
                result.largest_coc_px);
} catch (const postlens::Error& e) {
    return std::fprintf(stderr, "%s\n", e.what()), static_cast<int>(e.code());
}
