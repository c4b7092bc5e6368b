#include "postlens/lens.h"

#include <utility>

#include "core/files/scratch_file.h"
#include "pictures/image.h"
#include "postlens/internals.h"

namespace postlens::api {
namespace {

Words film_words(const char* command, const LensSettings& lens, const FilmSettings& film) {
    Words words{"lens", command};
    words.add(lens);
    words.add("--pixel-pitch", film.pixel_pitch_um);
    words.add("--coc-limit", film.coc_limit_mm);
    return words;
}

}  // namespace

CircleOfConfusion circle_of_confusion(const LensSettings& lens, double depth_m, const FilmSettings& film,
                                      Job* job) {
    return guarded(job, [&] {
        Words words = film_words("coc", lens, film);
        words.add("--depth", std::optional(depth_m));
        Outcome out = run_words(words);
        return CircleOfConfusion{
            .coc_mm = out.number("coc_mm"), .coc_px = out.number("coc_px"), .report = std::move(out.report)};
    });
}

DepthOfField depth_of_field(const LensSettings& lens, const FilmSettings& film, Job* job) {
    return guarded(job, [&] {
        Outcome out = run_words(film_words("dof", lens, film));
        return DepthOfField{.near_m = out.number("near_m"),
                            .far_m = out.number("far_m"),
                            .hyperfocal_m = out.number("hyperfocal_m"),
                            .report = std::move(out.report)};
    });
}

ImpulseResponse impulse_response(const ResponseSettings& settings, Job* job) {
    return guarded(job, [&] {
        const ScratchFile file("response.exr");
        Words words{"lens", "psf"};
        words.add_file("response", file.path());
        words.add(settings.lens);
        words.add("--depth", settings.depth_m);
        words.add("--wavelength", settings.wavelength_nm);
        words.add("--pixel-pitch", settings.pixel_pitch_um);
        words.add("--size", settings.size_px);
        words.add(settings.options);
        Outcome out = run_words(words);
        // The file has a single channel, which read_image returns as red, green and blue.
        const Image image = read_image(file.path());
        ImpulseResponse response{.width = image.width,
                                 .height = image.height,
                                 .values = {},
                                 .energy_in_frame = out.number("energy_in_frame"),
                                 .coc_px = out.number("coc_px"),
                                 .image_distance_mm = out.number("image_distance_mm"),
                                 .report = std::move(out.report)};
        response.values.reserve(image.rgb.size() / 3);
        for (std::size_t i = 0; i < image.rgb.size(); i += 3) response.values.push_back(image.rgb[i]);
        return response;
    });
}

}  // namespace postlens::api
