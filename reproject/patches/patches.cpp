#include "reproject/patches/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/threads.h"

namespace postlens {
namespace {

/// Largest error of position with which a blurred surface may be reprojected, as a fraction of the surface's
/// blur radius, i.e. the radius of its circle of confusion. The more a surface is blurred, the less a wrong
/// position is visible.
constexpr double exact_share = 0.02;
/// A hidden surface closely behind another surface could show through it, because the depths of both surfaces
/// have errors. Therefore, depth tests reduce the inverse depth of the hidden surface, so that it counts as
/// farther away. This is the largest reduction, as a fraction of the inverse depth.
constexpr double most_back = 0.02;
/// A surface is drawn without fine detail, with a single colour in each recorded pixel, if its circle of
/// confusion has at least this radius, in px. If the circle is distorted to an ellipse, the smaller semi-axis
/// counts.
constexpr double coarse_from_px = 6;

/// Fits linear functions of the position to several pixels of a surface by least squares. A pixel stores
/// `values` such functions: the inverse depth and, for reflections and refractions, the four entries of the
/// matrix W, which tells how far the image moves with the lens point.
template <std::size_t values>
class Fit {
  public:
    /// Adds the values of pixel (x, y) at four points, +-1/4 px from its centre in x and y, so that the
    /// slopes of its functions `planes` count too.
    void add(int x, int y, const CellPlane* planes) {
        const double px = x + 0.5, py = y + 0.5;
        n_ += 1;
        x_ += px;
        y_ += py;
        xx_ += px * px;
        xy_ += px * py;
        yy_ += py * py;
        for (std::size_t i = 0; i < values; ++i) {
            const auto value = static_cast<double>(planes[i].value);
            v_[i] += value;
            vx_[i] += value * px + spread * static_cast<double>(planes[i].x);
            vy_[i] += value * py + spread * static_cast<double>(planes[i].y);
        }
    }
    void solve() {
        const double mx = x_ / n_, my = y_ / n_;
        const double xx = xx_ / n_ + spread - mx * mx, xy = xy_ / n_ - mx * my,
                     yy = yy_ / n_ + spread - my * my;
        const double det = xx * yy - xy * xy;
        for (std::size_t i = 0; i < values; ++i) {
            const double mean = v_[i] / n_, cx = vx_[i] / n_ - mx * mean, cy = vy_[i] / n_ - my * mean;
            const double dx = (yy * cx - xy * cy) / det, dy = (xx * cy - xy * cx) / det;
            plane_[i] = {mean - dx * mx - dy * my, dx, dy};
        }
    }
    /// Returns how well this fit represents pixel (x, y): the largest difference, in 1/m, between the fitted
    /// functions and the pixel's own functions `planes`. They are compared at four points, +-1/4 px from the
    /// pixel's centre.
    [[nodiscard]] double error(int x, int y, const CellPlane* planes) const {
        double worst = 0;
        // Only functions that determine image positions are compared: the matrix W (motion of the image with
        // the lens point) if it is stored, otherwise the inverse depth.
        for (std::size_t i = first_moving; i < values; ++i) {
            const double middle = static_cast<double>(planes[i].value) - at(i, x + 0.5, y + 0.5),
                         across = static_cast<double>(planes[i].x) - plane_[i][1],
                         down = static_cast<double>(planes[i].y) - plane_[i][2];
            worst = std::max(worst, std::abs(middle) + quarter * (std::abs(across) + std::abs(down)));
        }
        return worst;
    }
    [[nodiscard]] double at(std::size_t i, double x, double y) const {
        return plane_[i][0] + plane_[i][1] * x + plane_[i][2] * y;
    }
    [[nodiscard]] CellPlane plane(std::size_t i) const {
        return {static_cast<float>(plane_[i][0]), static_cast<float>(plane_[i][1]),
                static_cast<float>(plane_[i][2])};
    }

  private:
    static constexpr double quarter = 0.25;              ///< distance of the points from the centre, px
    static constexpr double spread = quarter * quarter;  ///< variance of the points along an axis, px^2
    static constexpr std::size_t first_moving =
        values == 1 ? 0 : 1;  ///< first value that affects positions; 1/z' does not if W is stored
    double n_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0, yy_ = 0;
    std::array<double, values> v_{}, vx_{}, vy_{};
    std::array<std::array<double, 3>, values> plane_{};
};

template <std::size_t values>
class Cutter {
  public:
    Cutter(const SheetMesh& sheets, PatchLens lens, PatchMesh& out)
        : sheets_(sheets), lens_(std::move(lens)), out_(out) {}

    void cut(std::uint32_t sheet) {
        sheet_ = sheet;
        const Sheet& s = sheets_.sheets[sheet];
        blur_px_.resize(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height));
        each_cell(0, 0, s.width, s.height, [&](int, int, std::size_t k, const CellPlane* p) {
            blur_px_[k - s.first_cell] = lens_.least_blur_px(w_of(p));
            return true;
        });
        cut(0, 0, s.width, s.height);
    }

  private:
    [[nodiscard]] std::size_t cell(int x, int y) const {
        const Sheet& s = sheets_.sheets[sheet_];
        return s.first_cell + static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width) +
               static_cast<std::size_t>(x);
    }
    /// Calls `visit` for those pixels of a rectangle that show the surface `sheet_`, which is being divided.
    /// If `visit` returns false, stops and returns false. Otherwise, returns true.
    template <typename Visit>
    bool each_cell(int x0, int y0, int width, int height, const Visit& visit) const {
        for (int y = y0; y < y0 + height; ++y) {
            for (int x = x0; x < x0 + width; ++x) {
                const std::size_t k = cell(x, y);
                if (sheets_.fine[k] != SheetNode::none &&
                    !visit(x - x0, y - y0, k, sheets_.planes.data() + k * values))
                    return false;
            }
        }
        return true;
    }
    [[nodiscard]] Mat2 w_of(const CellPlane* p) const {
        if constexpr (values == 5) {
            return {p[1].value, p[2].value, p[3].value, p[4].value};
        } else {
            return Mat2::isotropic(p[0].value);
        }
    }

    void cut(int x0, int y0, int width, int height) {
        Fit<values> fit;
        double blur_px = HUGE_VAL;
        int cells = 0;
        const std::size_t first = sheets_.sheets[sheet_].first_cell;
        each_cell(x0, y0, width, height, [&](int x, int y, std::size_t k, const CellPlane* p) {
            fit.add(x, y, p);
            blur_px = std::min(blur_px, blur_px_[k - first]);
            ++cells;
            return true;
        });
        if (cells == 0) return;
        fit.solve();
        const MotionStrain strain = motion_of(x0, y0, width, height, fit);
        const double within = std::min(std::max(lens_.exact_px, exact_share * blur_px) / lens_.radius_px_m,
                                       lens_.exact_px / strain.px_m);
        if (width > 1 || height > 1) {
            const bool fits = each_cell(
                x0, y0, width, height,
                [&](int x, int y, std::size_t, const CellPlane* p) { return fit.error(x, y, p) <= within; });
            if (!fits || 2 * strain.bend_px > lens_.overlap_px) {
                const int left = (width + 1) / 2, upper = (height + 1) / 2;
                cut(x0, y0, left, upper);
                if (left < width) cut(x0 + left, y0, width - left, upper);
                if (upper < height) cut(x0, y0 + upper, left, height - upper);
                if (left < width && upper < height) cut(x0 + left, y0 + upper, width - left, height - upper);
                return;
            }
        }
        add(x0, y0, width, height, fit, blur_px, within);
    }

    [[nodiscard]] MotionStrain motion_of(int x0, int y0, int width, int height,
                                         const Fit<values>& fit) const {
        // Effects of motion are computed only for directly visible surfaces. These store one linear function
        // for each pixel, the inverse depth. Surfaces in mirrors or glass store five, because the four
        // entries of W (the motion of the image with the lens point) are added.
        if (values != 1 || !lens_.motion) return {};
        const Sheet& s = sheets_.sheets[sheet_];
        const glm::dvec2 half(width / 2.0, height / 2.0);
        const CellPlane plane = fit.plane(0);
        return lens_.motion(s.key, {s.x + x0 + half.x, s.y + y0 + half.y, fit.at(0, half.x, half.y)},
                            {plane.x, plane.y}, half);
    }

    void add(int x0, int y0, int width, int height, const Fit<values>& fit, double blur_px, double within) {
        Patch p;
        p.sheet = sheet_;
        p.x = static_cast<std::uint8_t>(x0);
        p.y = static_cast<std::uint8_t>(y0);
        p.width = static_cast<std::uint8_t>(width);
        p.height = static_cast<std::uint8_t>(height);
        p.coarse = blur_px >= coarse_from_px;
        const std::vector<std::uint32_t>& roots = p.coarse ? sheets_.coarse : sheets_.fine;
        bool divided = false;
        each_cell(x0, y0, width, height, [&](int, int, std::size_t k, const CellPlane*) {
            divided = divided || (roots[k] & SheetNode::leaf) == 0;
            if constexpr (values == 5) {
                // Sets `p.bent` if the patch's image may be reprojected with too large an error. `bend_px_m2`
                // converts this error, `bend`, to px at the rim of the lens. For a pinhole, the product may
                // be NaN (0 times infinity), which sets `p.bent` too, because the comparison is negated.
                const auto bend = static_cast<double>(sheets_.bends[k]);
                p.bent = p.bent || !(lens_.bend_px_m2 * bend <= most_bend_px);
            }
            return true;
        });
        p.depth = divided ? static_cast<std::uint8_t>(sheets_.sheets[sheet_].depth) : std::uint8_t{0};
        p.first_plane = static_cast<std::uint32_t>(out_.planes.size());
        for (std::size_t i = 0; i < values; ++i) out_.planes.push_back(fit.plane(i));
        if (sheets_.sheets[sheet_].key.hidden) {
            // This patch (part of a surface) lies closely behind another surface. The inverse depth of both
            // may be wrong by `within`, in 1/m, so the hidden patch could show through. Therefore, depth
            // tests reduce its inverse depth by 2 * within, but at most by `most`.
            const double most = most_back * static_cast<double>(out_.planes[p.first_plane].value);
            p.back_per_m = static_cast<float>(std::min(2 * within, most));
        }
        out_.patches.push_back(p);
    }

    const SheetMesh& sheets_;
    PatchLens lens_;
    PatchMesh& out_;
    std::uint32_t sheet_ = 0;
    std::vector<double> blur_px_;  ///< PatchLens::least_blur_px of each cell of the sheet
};

}  // namespace

PatchLens patch_lens(const FocusGeometry& geometry) {
    const double radius_px_m = geometry.gain_px * geometry.aperture_radius_m;
    PatchLens lens;
    lens.radius_px_m = radius_px_m;
    lens.inverse_focus_per_m = geometry.inverse_focus_per_m;
    lens.bend_px_m2 = radius_px_m * geometry.aperture_radius_m;
    return lens;
}

double PatchLens::least_blur_px(const Mat2& w) const {
    // The 2x2 matrix W (`w`) describes how the surface point's image moves with the lens point. A lens
    // focused at the distance s blurs the point to an ellipse. The smaller singular value of I / s - w gives
    // its smaller semi-axis, where I is the unit matrix.
    const double a = inverse_focus_per_m - static_cast<double>(w.xx), b = -static_cast<double>(w.xy),
                 c = -static_cast<double>(w.yx), d = inverse_focus_per_m - static_cast<double>(w.yy);
    // std::hypot would be slower, and this code runs for every pixel of every surface. Overflow cannot happen
    // here.
    const double sum = std::sqrt((a + d) * (a + d) + (b - c) * (b - c)),
                 difference = std::sqrt((a - d) * (a - d) + (b + c) * (b + c));
    return radius_px_m * std::abs(sum - difference) / 2;
}

PatchMesh cut_patches(const SheetMesh& sheets, const PatchLens& lens) {
    PatchMesh out;
    out.sheets = &sheets;
    out.overlap_px = static_cast<float>(lens.overlap_px);
    out.follows.reserve(sheets.sheets.size());
    for (const Sheet& sheet : sheets.sheets) {
        std::uint32_t follows = 0;
        for (std::size_t bounce = 0; bounce < 2; ++bounce) {
            const double strays_px = lens.radius_px_m * static_cast<double>(sheet.strays[bounce]);
            if (strays_px <= lens.follow_px || lens.follow_px == PatchLens::all_follow)
                follows |= 1U << bounce;
        }
        out.follows.push_back(static_cast<std::uint8_t>(follows));
    }
    constexpr std::size_t per_task = 256;
    const std::size_t tasks = (sheets.sheets.size() + per_task - 1) / per_task;
    std::vector<PatchMesh> parts(tasks);
    parallel_for(tasks, [&](std::size_t t) {
        const auto cut = [&](auto&& cutter) {
            for (std::size_t i = t * per_task; i < std::min((t + 1) * per_task, sheets.sheets.size()); ++i)
                cutter.cut(static_cast<std::uint32_t>(i));
        };
        if (sheets.has_w()) {
            cut(Cutter<5>(sheets, lens, parts[t]));
        } else {
            cut(Cutter<1>(sheets, lens, parts[t]));
        }
    });
    for (const PatchMesh& part : parts) {
        const auto first = static_cast<std::uint32_t>(out.planes.size());
        for (Patch p : part.patches) {
            p.first_plane += first;
            out.patches.push_back(p);
        }
        out.planes.insert(out.planes.end(), part.planes.begin(), part.planes.end());
    }
    return out;
}

bool place_patch(const PatchMesh& mesh, const Patch& patch, const RasterMap& motion, const LensShift& lens,
                 PatchPlace& out) {
    const CellPlane* p = mesh.planes.data() + patch.first_plane;
    const glm::dvec2 corner = mesh.corner(patch);
    if (motion.identity()) {
        out.move = glm::dmat2(1);
        out.from = corner;
        out.inverse_z = {static_cast<double>(p[0].value), static_cast<double>(p[0].x),
                         static_cast<double>(p[0].y)};
    } else {
        const glm::dvec2 half(patch.width / 2.0, patch.height / 2.0), slope(p[0].x, p[0].y);
        const RasterPoint middle{corner.x + half.x, corner.y + half.y,
                                 static_cast<double>(p[0].value) + glm::dot(slope, half)};
        const auto to = motion.tangent(middle, slope, half);
        if (!to) return false;
        out.move = {{to->by_x.x, to->by_x.y}, {to->by_y.x, to->by_y.y}};
        out.from = glm::dvec2(to->at.x, to->at.y) - out.move * half;
        out.inverse_z = {to->at.inverse_z - to->by_x.inverse_z * half.x - to->by_y.inverse_z * half.y,
                         to->by_x.inverse_z, to->by_y.inverse_z};
    }
    const glm::dvec2 q = lens.lens_px;
    out.from += lens.inverse_focus_per_m * q + lens.offset_px;
    if (!mesh.sheets->has_w()) {
        out.from -= out.inverse_z.x * q;
        out.move[0] -= out.inverse_z.y * q;
        out.move[1] -= out.inverse_z.z * q;
        out.inverse_z.x -= static_cast<double>(patch.back_per_m);
        return true;
    }
    const auto moved = [&](float CellPlane::*part) {
        return glm::dvec2(static_cast<double>(p[1].*part) * q.x + static_cast<double>(p[2].*part) * q.y,
                          static_cast<double>(p[3].*part) * q.x + static_cast<double>(p[4].*part) * q.y);
    };
    out.from -= moved(&CellPlane::value);
    out.move[0] -= moved(&CellPlane::x);
    out.move[1] -= moved(&CellPlane::y);
    out.inverse_z.x -= static_cast<double>(patch.back_per_m);
    return true;
}

namespace {

/// Returns the inverse depth of `part`, a rectangular part of the patch `whole`. It is a linear function of
/// the position on the raster: value at the part's corner, in 1/m, and slopes along x and y, per px.
glm::dvec3 inverse_z_of(const PatchMesh& mesh, const Patch& whole, const Patch& part) {
    const CellPlane& plane = mesh.planes[whole.first_plane];
    const glm::dvec2 slope(plane.x, plane.y);
    return {
        static_cast<double>(plane.value) + glm::dot(slope, glm::dvec2(part.x - whole.x, part.y - whole.y)),
        slope.x, slope.y};
}

// Maps a part of a surface to those pixels of a scene point's circle of confusion whose rays the part blocks.
// The ray from the scene point `at` to pixel p passes through the lens point q = L (p - at), with the matrix
// L = `lens_px_per_px`. From q, a surface point at raster position x is seen at p = x + (s - w) q, with its
// inverse depth w and the inverse focus distance s. Hence x - at = C (p - at) with C = I - (s - w) L. C
// depends on x, because w does. So the map is linearised around the part's centre.
bool place_part(const PatchMesh& mesh, const Patch& part, const glm::dvec3& inverse_z, const PointRays& rays,
                PatchPlace& out) {
    constexpr double least_determinant = 1e-9;
    out.inverse_z = inverse_z;
    const glm::dvec2 half(part.width / 2.0, part.height / 2.0), slope(inverse_z.y, inverse_z.z);
    const double w = inverse_z.x + glm::dot(slope, half);
    const glm::dmat2 c = glm::dmat2(1) - (rays.inverse_focus_per_m - w) * rays.lens_px_per_px;
    if (!(std::abs(glm::determinant(c)) > least_determinant)) return false;
    const glm::dmat2 back = glm::inverse(c);
    const glm::dvec2 middle = back * (mesh.corner(part) + half - rays.at);
    const glm::dvec2 by_depth = back * (rays.lens_px_per_px * middle);
    out.move[0] = back[0] - slope.x * by_depth;
    out.move[1] = back[1] - slope.y * by_depth;
    out.from = rays.at + middle - out.move * half;
    out.inverse_z.x -= static_cast<double>(part.back_per_m);
    return true;
}

struct Nearer {
    const PatchMesh& mesh;
    const Patch& whole;
    const PointRays& rays;
    double light_per_m, nearest_per_m;
    std::vector<PlacedPatch>& out;

    void add(const Patch& part) const {
        const glm::dvec3 z = inverse_z_of(mesh, whole, part);
        const double across = part.width * z.y, down = part.height * z.z,
                     low = z.x + std::min(across, 0.0) + std::min(down, 0.0),
                     high = z.x + std::max(across, 0.0) + std::max(down, 0.0);
        if (high <= nearest_per_m) return;
        // This part of a surface blocks the rays from a bright point to some pixels. The map from the part to
        // these pixels is approximated as linear. Therefore, the part is divided if its difference in inverse
        // depth to the bright point varies by more than a factor of 2.
        const bool is_cell = part.width == 1 && part.height == 1;
        if (is_cell || high - light_per_m <= 2 * (low - light_per_m)) {
            PlacedPatch placed{part, {}};
            if ((low + high) / 2 > nearest_per_m && place_part(mesh, part, z, rays, placed.place))
                out.push_back(placed);
            return;
        }
        Patch first = part, second = part;
        if (part.height == 1 || (part.width > 1 && std::abs(across) >= std::abs(down))) {
            first.width = static_cast<std::uint8_t>(part.width / 2);
            second.x = static_cast<std::uint8_t>(part.x + first.width);
            second.width = static_cast<std::uint8_t>(part.width - first.width);
        } else {
            first.height = static_cast<std::uint8_t>(part.height / 2);
            second.y = static_cast<std::uint8_t>(part.y + first.height);
            second.height = static_cast<std::uint8_t>(part.height - first.height);
        }
        add(first);
        add(second);
    }
};

}  // namespace

bool place_patch(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, PatchPlace& out) {
    return place_part(mesh, patch, inverse_z_of(mesh, patch, patch), rays, out);
}

void place_nearer(const PatchMesh& mesh, const Patch& patch, const PointRays& rays, double light_per_m,
                  double nearest_per_m, std::vector<PlacedPatch>& out) {
    Nearer{mesh, patch, rays, light_per_m, nearest_per_m, out}.add(patch);
}

RasterRect covered(const Patch& patch, const PatchPlace& place) {
    const glm::dvec2 across = static_cast<double>(patch.width) * place.move[0],
                     down = static_cast<double>(patch.height) * place.move[1];
    return {place.from.x + std::min(across.x, 0.0) + std::min(down.x, 0.0),
            place.from.x + std::max(across.x, 0.0) + std::max(down.x, 0.0),
            place.from.y + std::min(across.y, 0.0) + std::min(down.y, 0.0),
            place.from.y + std::max(across.y, 0.0) + std::max(down.y, 0.0)};
}

}  // namespace postlens
