#include "motionblur/groups/group_blur.h"

#include <algorithm>
#include <cmath>

#include "motionblur/paths/path_raster.h"

namespace postlens {
namespace {

void add(const GroupPicture& part, GroupPicture& to) {
    const auto columns = static_cast<std::size_t>(to.x_end - to.x_begin);
    const int y_begin = std::max(part.y_begin, to.y_begin), y_end = std::min(part.y_end, to.y_end);
    const int x_begin = std::max(part.x_begin, to.x_begin), x_end = std::min(part.x_end, to.x_end);
    for (int y = y_begin; y < y_end; ++y) {
        for (int x = x_begin; x < x_end; ++x) {
            auto& sum = to.rgba[static_cast<std::size_t>(y - to.y_begin) * columns +
                                static_cast<std::size_t>(x - to.x_begin)];
            const auto& own = *part.at(x, y);
            for (std::size_t k = 0; k < 4; ++k) sum[k] += own[k];
        }
    }
}

}  // namespace

GroupPicture GroupBlur::whole(const Planes& i1, const MovingGroup& group) const {
    return in_pixels(convolved(i1, group.path, {}), cells_per_px_, width_, height_);
}

GroupPicture GroupBlur::sliced(const DepthSlices& slices, const MovingGroup& group) const {
    GroupPicture out = nothing_over(slices, group);
    std::vector<std::vector<double>> along;
    for (const PathAxis& axis : slices.axes()) {
        along.emplace_back();
        for (const PathPoint& p : group.path)
            along.back().push_back(std::max(0.0, glm::dot(p.at_px, axis.direction) - axis.low_px));
    }
    for (int k = 0; k < slices.count(); ++k) {
        const SliceRaster i1 = slices.draw(k);
        std::vector<PathPoint> path = group.path;
        for (PathPoint& p : path) p.at_px *= slices.path_scale(k);
        add(in_pixels(convolved(i1.flat, path, {}), cells_per_px_, width_, height_), out);
        for (std::size_t a = 0; a < i1.stretched.size(); ++a)
            add(in_pixels(convolved(i1.stretched[a], path, along[a]), cells_per_px_, width_, height_), out);
    }
    // An FFT can change the coverage p[3] of a pixel by a rounding error of up to least_coverage. `out` is
    // the sum of several convolved slices, so a pixel with a coverage of at most `rounding` may really be
    // empty. Such a pixel is set to 0.
    const float rounding = least_coverage * static_cast<float>(slices.count());
    for (auto& p : out.rgba) {
        if (p[3] <= rounding) p = {0, 0, 0, 0};
        // The coverage p[3] can exceed 1 where parts of a moving object overlap.
        const float scale = p[3] > 1 ? 1 / p[3] : 1;
        for (float& v : p) v = std::max(0.0F, v * scale);
    }
    return out;
}

Planes GroupBlur::convolved(const Planes& i1, const std::vector<PathPoint>& path,
                            const std::vector<double>& values) const {
    // `i1` is an image of the moving objects. Displacements that move all of it out of the frame contribute
    // nothing to the blurred image. So the blur kernel `i2` is drawn only in the window `reach`, which
    // contains all other displacements.
    const CellWindow frame{0, width_ * cells_per_px_, 0, height_ * cells_per_px_};
    const CellWindow reach{frame.x_begin - (i1.x_begin + i1.width), frame.x_end - i1.x_begin,
                           frame.y_begin - (i1.y_begin + i1.height), frame.y_end - i1.y_begin};
    const PathRaster i2 =
        draw_path(path, {0, 0}, exposure_.open_s, exposure_.close_s, curve_, cells_per_px_, reach, values);
    return convolve(i1, i2, ConvolutionMethod::automatic, nullptr, frame);
}

// Creates an empty image, to which the blurred slices of a group of moving objects are added. It contains the
// area over which the group can pass during the exposure.
GroupPicture GroupBlur::nothing_over(const DepthSlices& slices, const MovingGroup& group) const {
    glm::dvec2 low(0), high(0);
    for (const PathPoint& p : group.path) {
        for (const int k : {0, slices.count() - 1}) {
            low = glm::min(low, slices.path_scale(k) * p.at_px);
            high = glm::max(high, slices.path_scale(k) * p.at_px);
        }
    }
    const CellWindow& w = slices.window();
    const double c = cells_per_px_;
    const auto within = [](double px, int limit) {
        return static_cast<int>(std::clamp(px, 0.0, static_cast<double>(limit)));
    };
    // The bounding box of the blurred object is enlarged by 1 px on all sides. The object may extend slightly
    // beyond its motion path, because displacements are rounded to whole raster cells, which shifts it by up
    // to half a cell.
    GroupPicture out;
    out.x_begin = within(std::floor(w.x_begin / c + low.x) - 1, width_);
    out.x_end = std::max(out.x_begin, within(std::ceil(w.x_end / c + high.x) + 1, width_));
    out.y_begin = within(std::floor(w.y_begin / c + low.y) - 1, height_);
    out.y_end = std::max(out.y_begin, within(std::ceil(w.y_end / c + high.y) + 1, height_));
    out.rgba.assign(
        static_cast<std::size_t>(out.x_end - out.x_begin) * static_cast<std::size_t>(out.y_end - out.y_begin),
        {0, 0, 0, 0});
    return out;
}

}  // namespace postlens
