#include "postlens/compare.h"

#include <utility>

#include "core/files/scratch_file.h"
#include "pictures/image.h"
#include "postlens/internals.h"

namespace postlens::api {

CompareResult compare(const std::filesystem::path& image, const std::filesystem::path& reference,
                      const CompareSettings& settings, Job* job) {
    return guarded(job, [&] {
        Words words{"compare"};
        words.add_file("image", image);
        words.add_file("reference", reference);
        words.add("--noise", settings.noise);
        words.add("--pinhole", settings.pinhole);
        words.add("--map", settings.map);
        words.add("--side-by-side", settings.side_by_side);
        words.add("--exposure", settings.exposure);
        words.add("--fail-psnr", settings.fail_psnr_db);
        words.add("--fail-relmse", settings.fail_relmse);
        words.add("--fail-flip", settings.fail_flip);
        words.add(settings.options);
        Outcome out = run_words(words);
        return CompareResult{.psnr_db = out.number("psnr_db"),
                             .rmse = out.number("rmse"),
                             .relmse = out.number("relmse"),
                             .ssim = out.number("ssim"),
                             .flip = out.number("flip"),
                             .identical = out.result.json.value("identical", false),
                             .affected_share = out.number_if_known("affected_share"),
                             .affected_psnr_db = out.number_if_known("affected_psnr_db"),
                             .noise_psnr_db = out.number_if_known("noise_psnr_db"),
                             .report = std::move(out.report)};
    });
}

CompareResult compare(const Picture& image, const Picture& reference, const CompareSettings& settings,
                      Job* job) {
    return guarded(job, [&] {
        const ScratchFile image_file("image.exr"), reference_file("reference.exr");
        write_image(image_file.path(), image_of(image));
        write_image(reference_file.path(), image_of(reference));
        return compare(image_file.path(), reference_file.path(), settings, job);
    });
}

}  // namespace postlens::api
