#include "pictures/crop.h"

#include <algorithm>

#include "core/error.h"

namespace postlens {

void check_crop(const std::optional<Crop>& crop, int width, int height) {
    if (!crop) return;
    const auto within = [](int begin, int size, int all) {
        return begin >= 0 && size > 0 && begin < all && size <= all - begin;
    };
    if (within(crop->x, crop->width, width) && within(crop->y, crop->height, height)) return;
    fail(ExitCode::wrong_arguments,
         "--crop: not within the picture (got {},{},{},{}; expected X,Y,W,H within {}x{} px, W and H 1 or "
         "more)",
         crop->x, crop->y, crop->width, crop->height, width, height);
}

std::size_t wanted_pixels(const std::optional<Crop>& crop, int width, int height) {
    return crop ? static_cast<std::size_t>(crop->width) * static_cast<std::size_t>(crop->height)
                : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

Image cut(const Image& picture, const std::optional<Crop>& crop) {
    if (!crop) return picture;
    check_crop(crop, picture.width, picture.height);
    Image out(crop->width, crop->height);
    for (int y = 0; y < crop->height; ++y)
        std::copy_n(picture.pixel(crop->x, crop->y + y), 3 * crop->width, out.pixel(0, y));
    out.exposure_stops = picture.exposure_stops;
    out.alpha = cut(picture.alpha, picture.width, crop);
    for (const Image::Plane& p : picture.planes)
        out.planes.push_back({p.name, cut(p.values, picture.width, crop)});
    out.texts = picture.texts;
    out.made_by = picture.made_by;
    return out;
}

}  // namespace postlens
