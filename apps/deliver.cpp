#include "apps/deliver.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "pictures/crop.h"
#include "pictures/exposure.h"
#include "pictures/picture_part.h"

namespace postlens {

void check_output(const std::string& output) {
    if (!output.empty()) check_image_path(output);
}

void deliver(Image image, const Delivery& to, CommandResult& out) {
    image.made_by = to.made_by;
    if (to.shared) mark_as_part(image, to.crop, to.shared->mark);
    if (!to.output.empty()) write_image(to.output, image, to.crop);
    report_picture(image, to.output, to.crop, out);
    if (to.output.empty()) out.pictures.push_back(to.crop ? cut(image, to.crop) : std::move(image));
}

void report_picture(const Image& image, const std::string& output, const std::optional<Crop>& crop,
                    CommandResult& out) {
    if (crop) {
        out.json["crop"] = {{"x", crop->x}, {"y", crop->y}, {"width", crop->width}, {"height", crop->height}};
        out.text += fmt::format("\n  only {}x{} px of it, from {},{} on", crop->width, crop->height, crop->x,
                                crop->y);
    }
    out.json["exposure_stops"] = image.exposure_stops.value_or(0);
    std::string ending = std::filesystem::path(output).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending.empty() || ending == ".exr") return;
    if (const auto warning = exposure_warning(image, crop))
        out.warnings.push_back({"exposure", warning->text, warning->share});
}

}  // namespace postlens
