#include "pictures/aperture_file.h"

#include <algorithm>

#include "core/error.h"
#include "pictures/image.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr int most_cells = 512;

AperturePicture read_picture(const std::filesystem::path& path) {
    const Image image = read_image(path, PictureValues::stored);
    const int step = (std::max(image.width, image.height) + most_cells - 1) / most_cells;
    AperturePicture out{(image.width + step - 1) / step, (image.height + step - 1) / step, {}};
    out.light.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), 0);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float* rgb = image.pixel(x, y);
            out.light[static_cast<std::size_t>(y / step) * static_cast<std::size_t>(out.width) +
                      static_cast<std::size_t>(x / step)] += exact_luminance(rgb);
        }
    }
    return out;
}

}  // namespace

Aperture read_aperture(const Impulse& impulse) {
    check_impulse(impulse);
    switch (impulse.kind) {
        case ImpulseKind::disc:
        case ImpulseKind::polygon:
            return Aperture(impulse);
        case ImpulseKind::picture:
            return Aperture(impulse, read_picture(impulse.file));
        case ImpulseKind::diffraction:
        case ImpulseKind::lens:
            break;
    }
    fail(ExitCode::wrong_arguments, "--impulse: no aperture (got {}; expected disc, polygon or image)",
         impulse_text(impulse));
}

}  // namespace postlens
