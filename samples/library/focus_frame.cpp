// Example of using the library: the image of a sample file through a 50 mm lens at f/2, focused at 3 m.
#include <cstdio>
#include <postlens/focus.h>

int main(int argc, char** argv) try {
    if (argc != 3) return std::fprintf(stderr, "usage: focus_frame FRAME.exr IMAGE\n"), 2;
    namespace pl = postlens::api;
    const pl::Frame frame(argv[1]);  // stays open, and may make more pictures
    const pl::FocusResult result =
        pl::focus(frame, {.lens = {.focal_length_mm = 50, .f_number = 2, .focus_distance_m = 3}});
    pl::save_picture(argv[2], result.picture);  // result.picture.rgb has the pixels in memory
    std::printf("%dx%d px, widest circle of confusion %.1f px\n", result.picture.width, result.picture.height,
                result.largest_coc_px.value_or(0));
} catch (const postlens::api::Error& e) {
    return std::fprintf(stderr, "%s\n", e.what()), static_cast<int>(e.code());
}
