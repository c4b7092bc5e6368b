#include "reproject/motion_parallax.h"

#include <algorithm>
#include <cmath>

namespace postlens {

double MotionParallax::operator()(const Sheet& sheet) const {
    const SheetKey& key = sheet.key;
    const std::size_t motion = motion_class(key.path.bits() == 0 ? key.id : key.parent_id);
    const double x = sheet.x + sheet.width / 2.0, y = sheet.y + sheet.height / 2.0,
                 inverse_z =
                     (static_cast<double>(sheet.inverse_z_min) + static_cast<double>(sheet.inverse_z_max)) /
                     2;
    // A step that doubles can tell apart, small against every depth.
    const double step = 1e-4 * std::max(inverse_z, 1e-4);
    double most = 0;
    for (const std::vector<RasterMap>& maps : views) {
        if (motion >= maps.size() || maps[motion].identity()) continue;
        const auto at = maps[motion]({x, y, inverse_z}), nearer = maps[motion]({x, y, inverse_z + step});
        if (at && nearer) most = std::max(most, std::hypot(nearer->x - at->x, nearer->y - at->y) / step);
    }
    return most;
}

}  // namespace postlens
