#include "apps/command.h"

namespace postlens {

CommandResult run_image(const std::string& input, const std::string& output) {
    check_image_path(output);
    const SampleFileReader file(input);
    const Image image = pinhole_picture(file);
    write_image(output, image);
    CommandResult out;
    out.json = {{"width", image.width}, {"height", image.height}, {"records", file.record_count()}};
    out.text = fmt::format("{}: {}x{} px, pinhole", output, image.width, image.height);
    return out;
}

}  // namespace postlens
