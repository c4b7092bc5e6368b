#include "lens/wave/lens_response.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"
#include "core/units.h"
#include "lens/aperture_response.h"
#include "lens/ellipse_coverage.h"
#include "lens/focus_geometry.h"
#include "lens/wave/diffraction_response.h"
#include "lens/wave/wave_scale.h"

namespace postlens {
namespace {

constexpr int largest_size_px = 16384, largest_own_size_px = 1025;
constexpr double airy_first_zero = 3.8317059702075125;

void check(const LensResponseRequest& request) {
    if (request.impulse.kind == ImpulseKind::lens) {
        fail(ExitCode::wrong_arguments,
             "the response of a prescription is not that of a thin lens (got --impulse {}; expected another "
             "kind)",
             impulse_text(request.impulse));
    }
    check_impulse(request.impulse);
    if (request.focus_distance_m <= request.lens.focal_length_mm * metres_per_mm) {
        fail(ExitCode::wrong_arguments,
             "focus distance lies within the focal length, where the lens forms no real image (got {} m; "
             "expected more than {} m)",
             request.focus_distance_m, request.lens.focal_length_mm * metres_per_mm);
    }
    const double V_mm = image_distance_mm(request.lens, request.focus_distance_m);
    (void)focus_geometry(request.lens, request.focus_distance_m, Framing::breathing,
                         {V_mm > 0 ? V_mm : 1, request.pixel_pitch_mm});
    if (!(request.depth_m > 0)) {
        fail(ExitCode::wrong_arguments, "depth is out of range (got {} m; expected more than 0, or infinity)",
             request.depth_m);
    }
    if (request.size_px < 0 || request.size_px > largest_size_px) {
        fail(ExitCode::wrong_arguments,
             "size of the response is out of range (got {} px; expected 1 to {} px)", request.size_px,
             largest_size_px);
    }
    if (request.impulse.kind == ImpulseKind::diffraction && std::isinf(request.lens.f_number)) {
        fail(ExitCode::wrong_arguments,
             "a pinhole without a width diffracts without bounds (got an f-number of inf; expected a finite "
             "one)");
    }
}

ResponseGrid frame(int size_px) {
    const int begin = -(size_px / 2);
    return {begin, begin, size_px, size_px};
}

double middle(int size_px) {
    return size_px % 2 == 0 ? 0 : 0.5;
}

void fill_disc(double radius_px, double centre, ResponseGrid& grid) {
    // Smallest radius of the disc that is drawn. With radius 0, the coverage would be divided by an area of
    // 0.
    constexpr double least_radius_px = 1e-6;
    const EllipseRows rows(Ellipse::disc(std::max(radius_px, least_radius_px)), centre, centre);
    CoverageSpan span;
    for (int j = 0; j < grid.height; ++j) {
        const int y = grid.y_begin + j;
        if (y < rows.y_begin() || y >= rows.y_end()) continue;
        rows.row(y, span);
        const int x_end = std::min(span.x_end, grid.x_begin + grid.width);
        for (int x = std::max(span.x_begin, grid.x_begin); x < x_end; ++x) {
            const bool inside = x >= span.inner_begin && x < span.inner_end;
            const int edge = x < span.inner_begin ? x - span.x_begin
                                                  : x - span.inner_end + (span.inner_begin - span.x_begin);
            grid.at(x - grid.x_begin, j) =
                inside ? rows.inner_share() : span.edge_share[static_cast<std::size_t>(edge)];
        }
    }
}

std::vector<double> profile_radii(double half_px, double v_per_px) {
    // The radial profile is computed at `per_v` radii for each unit of the optical radius v, but at least at
    // `fewest` radii. The time for one radius is proportional to v. So the number of radii times the largest
    // v is limited to `most_steps`, which takes a few seconds.
    constexpr double per_v = 4, fewest = 512, most_steps = 2e9;
    const double most = std::clamp(most_steps / std::max(half_px * v_per_px, 1.0), fewest, 8192.0);
    const auto count = static_cast<std::size_t>(std::clamp(half_px * v_per_px * per_v, fewest, most));
    std::vector<double> radii(count + 1);
    for (std::size_t i = 0; i <= count; ++i) {
        radii[i] = half_px * static_cast<double>(i) / static_cast<double>(count);
    }
    return radii;
}

/// Returns the full width at half maximum: twice the largest radius at which the intensity is half its
/// maximum. Samples are interpolated linearly.
std::optional<double> full_width(const std::vector<RadialSample>& profile) {
    const auto by_intensity = [](const RadialSample& a, const RadialSample& b) {
        return a.intensity < b.intensity;
    };
    const double half = std::max_element(profile.begin(), profile.end(), by_intensity)->intensity / 2;
    for (std::size_t i = profile.size() - 1; i > 0; --i) {
        const RadialSample &in = profile[i - 1], &out = profile[i];
        if (in.intensity < half) continue;
        if (out.intensity >= half) return std::nullopt;
        const double t = (in.intensity - half) / (in.intensity - out.intensity);
        return 2 * (in.radius_px + t * (out.radius_px - in.radius_px));
    }
    return std::nullopt;
}

std::optional<double> half_energy_diameter(const std::vector<RadialSample>& profile) {
    constexpr double half = 0.5;
    if (profile.front().encircled >= half) return 2 * profile.front().radius_px;
    for (std::size_t i = 1; i < profile.size(); ++i) {
        const RadialSample &in = profile[i - 1], &out = profile[i];
        if (out.encircled < half) continue;
        const double t = (half - in.encircled) / (out.encircled - in.encircled);
        return 2 * (in.radius_px + t * (out.radius_px - in.radius_px));
    }
    return std::nullopt;
}

/// Returns an upper bound of the memory, in bytes, for an impulse response of size_px x size_px pixels,
/// together with two temporary arrays of the same size.
double frame_bytes(int size_px) {
    return 3 * static_cast<double>(size_px) * size_px * sizeof(double);
}

void make_disc(LensResponse& out, int size_px) {
    require_memory(static_cast<std::uint64_t>(frame_bytes(size_px)), "the impulse response");
    const double radius_px = std::abs(out.coc_px) / 2;
    out.grid = frame(size_px);
    fill_disc(radius_px, middle(size_px), out.grid);
    for (const double r : profile_radii(size_px / 2.0, 0)) {
        const double share = radius_px > 0 ? std::min(r * r / (radius_px * radius_px), 1.0) : 1;
        // `inside` is the intensity in the blur disc, relative to the peak of the same lens in focus. The
        // disc is uniform, and its radius is R = u / v_per_px, in px. Here, u is the defocus and v_per_px the
        // width of a pixel, both in optical units. So an energy of 1 has the intensity 1 / (pi R^2) in the
        // disc. The peak in focus has the intensity v_per_px^2 / (4 pi), per px^2. The quotient of these
        // intensities is 4 / u^2.
        const double inside = out.u != 0 ? 4 / (out.u * out.u) : std::numeric_limits<double>::infinity();
        out.profile.push_back({r, r * out.v_per_px, r <= radius_px ? inside : 0, share});
    }
    if (radius_px <= size_px / 2.0) out.fwhm_px = 2 * radius_px;
}

/// Computes the impulse response, without diffraction, of an aperture. The aperture need not be round, so no
/// radial profile is computed.
void make_geometric(LensResponse& out, int size_px, const Aperture& aperture, double spherical_px) {
    require_memory(static_cast<std::uint64_t>(frame_bytes(size_px)), "the impulse response");
    const ApertureImage image{.map_px = glm::dmat2(out.coc_px / 2),
                              .spherical_px = spherical_px,
                              .centre_px = glm::dvec2(middle(size_px))};
    const int begin = -(size_px / 2), end = begin + size_px;
    const ResponseGrid made = dense_response(aperture, image, {begin, end, begin, end});
    out.grid = frame(size_px);
    for (int j = 0; j < made.height; ++j) {
        for (int i = 0; i < made.width; ++i) {
            out.grid.at(made.x_begin + i - begin, made.y_begin + j - begin) = std::max(made.at(i, j), 0.0);
        }
    }
}

void make_diffraction(LensResponse& out, int size_px, const std::vector<WaveScale>& scales) {
    const double centre = middle(size_px);
    ResponseGrid window;  // only its size, without values
    window.x_begin = window.y_begin = -(size_px / 2);
    window.width = window.height = size_px;
    const double reach = reach_px(window, centre, centre, {});
    double entries = 0;
    for (const WaveScale& scale : scales) check_defocus(scale.u);
    for (const WaveScale& scale : scales) entries += reach * scale.v_per_px / RadialEnergy::step_for(scale.u);
    require_memory(
        static_cast<std::uint64_t>(std::min(5 * entries * sizeof(double) + frame_bytes(size_px), 1e18)),
        "the diffraction pattern");
    out.grid = frame(size_px);
    std::vector<RadialEnergy> energies;
    energies.reserve(scales.size());
    std::vector<RadialProfile::Part> parts;
    double peak_density = 0;
    for (const WaveScale& scale : scales) {
        energies.emplace_back(scale.u, reach * scale.v_per_px);
        const double weight = 1 / static_cast<double>(scales.size());
        parts.push_back({&energies.back(), scale.v_per_px, weight});
        peak_density += weight * scale.v_per_px * scale.v_per_px / (4 * std::numbers::pi);
    }
    const RadialProfile profile(std::move(parts));
    fill_pixel_energy(profile, centre, centre, {}, out.grid);
    const std::vector<double> radii = profile_radii(size_px / 2.0, profile.v_per_px());
    out.profile.resize(radii.size());
    parallel_for(
        radii.size(),
        [&](std::size_t i) {
            const double r = radii[i];
            out.profile[i] = {r, r * out.v_per_px, profile.density(r) / peak_density, profile.within(r)};
        },
        64);
    out.fwhm_px = full_width(out.profile);
}

/// Returns the default width of the pixel grid for an impulse response, as an odd number of px. Without
/// diffraction, all light falls within `farthest_px` of the grid's centre. With diffraction, the light has no
/// limit, so the grid contains about 99 % of it.
int own_size_px(const std::vector<WaveScale>& scales, double farthest_px, bool diffracts) {
    double radius = farthest_px + 1;
    for (const WaveScale& scale : scales) {
        if (diffracts) radius = std::max(radius, radius_of_tail(scale.u, 0.01) / scale.v_per_px);
    }
    constexpr double least = 4, most = (largest_own_size_px - 1) / 2.0;
    return 2 * static_cast<int>(std::ceil(std::clamp(radius, least, most))) + 1;
}

}  // namespace

LensResponse lens_response(const LensResponseRequest& request) {
    check(request);
    const bool diffracts = request.impulse.kind == ImpulseKind::diffraction;
    const bool named = !request.impulse.wavelengths_nm.empty();
    const std::vector<double> wavelengths_nm =
        named ? request.impulse.wavelengths_nm : std::vector{request.wavelength_nm};
    std::vector<WaveScale> scales;
    for (const SpectralLine& line : equal_lines(wavelengths_nm)) {
        scales.push_back(wave_scale(request.lens, request.focus_distance_m, request.depth_m,
                                    request.pixel_pitch_mm, line.wavelength_nm));
    }
    LensResponse out;
    out.coc_px =
        coc_diameter_mm(request.lens, request.focus_distance_m, request.depth_m) / request.pixel_pitch_mm;
    out.image_distance_mm = image_distance_mm(request.lens, request.focus_distance_m);
    out.wavelength_nm = std::accumulate(wavelengths_nm.begin(), wavelengths_nm.end(), 0.0) /
                        static_cast<double>(wavelengths_nm.size());
    const WaveScale mean = wave_scale(request.lens, request.focus_distance_m, request.depth_m,
                                      request.pixel_pitch_mm, out.wavelength_nm);
    out.u = mean.u;
    out.v_per_px = mean.v_per_px;
    out.airy_diameter_px = 2 * airy_first_zero / out.v_per_px;
    const bool plain_disc = request.impulse.kind == ImpulseKind::disc && !request.aperture &&
                            request.impulse.squeeze == 1 && request.impulse.spherical == 0;
    const Aperture aperture = request.aperture ? *request.aperture : Aperture(request.impulse);
    const double spherical_px = aperture.spherical_per_m() * out.image_distance_mm / request.pixel_pitch_mm *
                                request.lens.aperture_diameter_mm() / 2 * metres_per_mm;
    const double farthest_px = farthest_light_px(aperture, out.coc_px / 2, spherical_px);
    const int size_px = request.size_px > 0 ? request.size_px : own_size_px(scales, farthest_px, diffracts);
    if (diffracts) {
        make_diffraction(out, size_px, scales);
    } else if (plain_disc) {
        make_disc(out, size_px);
    } else {
        make_geometric(out, size_px, aperture, spherical_px);
    }
    if (!out.profile.empty()) out.half_energy_diameter_px = half_energy_diameter(out.profile);
    out.energy_in_frame = std::accumulate(out.grid.share.begin(), out.grid.share.end(), 0.0);
    out.peak_share = *std::max_element(out.grid.share.begin(), out.grid.share.end());
    return out;
}

}  // namespace postlens
