#include "apps/command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/open_frame.h"

namespace postlens {

CommandResult run_image(const ImageOptions& options) {
    const std::string& output = options.output;
    check_output(output);
    // Another program's image is processed by `foreign_image`. The function `is_foreign` recognises such an
    // image by the file's content, which may be unreadable if the file is damaged. Therefore, with --salvage,
    // which reads damaged sample files, the file is assumed to be a sample file.
    if (!options.salvage && is_foreign(options.input)) return foreign_image(options);
    refuse_foreign_options(options.foreign, options.input);
    const Damage damage = damage_rule(options.salvage);
    const auto open = open_frame(options.input, options.kept,
                                 exposure_of_samples(options.exposure, options.input, damage), damage);
    const SampleFileReader& file = open->file;
    Image image = pinhole_picture(file, options.crop);
    const int width = options.crop ? options.crop->width : image.width,
              height = options.crop ? options.crop->height : image.height;
    CommandResult out;
    warn_of_missing_rows(file, out.warnings);
    out.json = {{"width", width}, {"height", height}, {"records", file.record_count()}};
    out.text = fmt::format("{}: {}x{} px, pinhole", output, width, height);
    deliver(std::move(image), {output, options.crop, options.made_by, {}}, out);
    return out;
}

}  // namespace postlens
