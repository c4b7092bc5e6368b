#include "apps/command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/open_frame.h"

namespace postlens {

CommandResult run_image(const ImageOptions& options) {
    const std::string& output = options.output;
    check_output(output);
    // Tests whether the input is an image of another program, which `foreign_image` processes, and not a
    // sample file. `is_foreign` reads the file's header, which may be damaged. But with --salvage, which is
    // only for damaged sample files, the input is assumed to be a sample file.
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
