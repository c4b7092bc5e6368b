#include "lens/wave/fourier_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <fftw3.h>
#include <memory>
#include <mutex>
#include <new>
#include <numbers>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"

namespace postlens {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// FFTW's planner is not thread-safe, so this mutex guards it.
std::mutex& planner() {
    static std::mutex mutex;
    return mutex;
}

struct Free {
    void operator()(void* p) const { fftw_free(p); }
};
template <typename T>
using Array = std::unique_ptr<T[], Free>;

template <typename T>
Array<T> allocate(std::size_t count) {
    auto* p = static_cast<T*>(fftw_malloc(count * sizeof(T)));
    if (p == nullptr) throw std::bad_alloc();
    return Array<T>(p);
}

fftw_complex* raw(Complex* p) {
    return reinterpret_cast<fftw_complex*>(p);
}

/// Makes an FFTW plan, runs it once and destroys it. Plans are estimated, because measured plans may differ
/// from run to run and change the rounding.
template <typename Make>
void transform(const Make& make) {
    fftw_plan plan = nullptr;
    {
        const std::lock_guard lock(planner());
        plan = make();
    }
    if (plan == nullptr) throw std::bad_alloc();
    fftw_execute(plan);
    const std::lock_guard lock(planner());
    fftw_destroy_plan(plan);
}

int next_smooth_even(double at_least) {
    for (int n = std::max(2, 2 * static_cast<int>(std::ceil(at_least / 2)));; n += 2) {
        int rest = n;
        for (const int factor : {2, 3, 5}) {
            while (rest % factor == 0) rest /= factor;
        }
        if (rest == 1) return n;
    }
}

/// Phase in the pupil, rad: the phase -u p^2 / 2 of defocus, plus the aberrations with the same sign.
double phase(const FourierResponse& r, double x, double y) {
    return -(r.u * (x * x + y * y) / 2 + 2 * pi * wavefront_waves(r.wavefront, x, y));
}

/// Largest slope of the phase over the pupil, rad per pupil radius, from finite differences on a grid.
double steepest(const FourierResponse& r) {
    constexpr int steps = 96;
    constexpr double h = 1.0 / steps;
    double most = 0;
    for (int j = -steps; j < steps; ++j) {
        for (int i = -steps; i < steps; ++i) {
            const double x = i * h, y = j * h;
            if (std::hypot(x + h / 2, y + h / 2) > 1) continue;
            const double here = phase(r, x, y);
            most = std::max(
                {most, std::abs(phase(r, x + h, y) - here) / h, std::abs(phase(r, x, y + h) - here) / h});
        }
    }
    return most;
}

/// Converts a signed index k on a periodic axis to an index in [0, size).
std::size_t wrapped(int k, int size) {
    return static_cast<std::size_t>(k < 0 ? k + size : k);
}

/// Means of the complex amplitude and of the transmitted light over one cell of the pupil.
struct Cell {
    Complex wave = 0;
    double light = 0;
};

/// Integrates over one cell of the pupil. If the corners have the same transmission as the centre, 3 x 3
/// Gauss nodes are sufficient: for a phase that changes by a quarter wave, the error is 1e-6. Otherwise an
/// edge crosses the cell, and 16 x 16 points are used.
Cell cell_of(const FourierResponse& r, double x, double y, double width) {
    const auto light = [&](double px, double py) {
        return std::abs(px) <= 1 && std::abs(py) <= 1 ? r.transmission(px, py) : 0;
    };
    Cell cell;
    const auto add = [&](double px, double py, double weight) {
        const double passes = light(px, py);
        if (passes == 0) return;
        cell.light += weight * passes;
        cell.wave += std::polar(weight * std::sqrt(passes), phase(r, px, py));
    };
    const double half = width / 2, middle = light(x, y);
    if (light(x - half, y - half) == middle && light(x + half, y - half) == middle &&
        light(x - half, y + half) == middle && light(x + half, y + half) == middle) {
        if (middle == 0) return cell;
        constexpr std::array<double, 3> at = {-0.3872983346207417, 0, 0.3872983346207417};  // sqrt(3/5) / 2
        constexpr std::array<double, 3> weight = {5.0 / 18, 8.0 / 18, 5.0 / 18};
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t i = 0; i < 3; ++i)
                add(x + at[i] * width, y + at[j] * width, weight[i] * weight[j]);
        }
        return cell;
    }
    constexpr int points = 16;
    for (int j = 0; j < points; ++j) {
        for (int i = 0; i < points; ++i) {
            add(x + ((i + 0.5) / points - 0.5) * width, y + ((j + 0.5) / points - 0.5) * width,
                1.0 / (points * points));
        }
    }
    return cell;
}

}  // namespace

double FourierSampling::bytes() const {
    // Memory of the complex field and of the real intensity.
    return static_cast<double>(size) * size * 3 * sizeof(double);
}

FourierSampling fourier_sampling(const FourierResponse& r, const ResponseGrid& window) {
    check_wavefront(r.wavefront);
    if (!(r.v_per_px > 0 && r.v_per_px < 1e6) || !(std::abs(r.u) < 1e6)) {
        fail(ExitCode::wrong_arguments,
             "diffraction is out of range (got u = {} and {} of v to a pixel; expected u within 1e6, v more "
             "than "
             "0 and less than 1e6)",
             r.u, r.v_per_px);
    }
    FourierSampling s;
    constexpr double most_v_step = 1.1;  // pi / (2 sqrt 2): apertures may fill the square around the disc
    s.samples_per_px = static_cast<int>(std::ceil(r.v_per_px / most_v_step));
    s.v_step = r.v_per_px / s.samples_per_px;
    const double slope = steepest(r);
    constexpr double fewest_cells = 96;
    const double cells = std::max(fewest_cells, slope / (pi / 2));
    const auto furthest = [](int begin, int count, double centre) {
        return std::max(std::abs(begin - centre), std::abs(begin + count - centre));
    };
    const double window_v = r.v_per_px * std::max(furthest(window.x_begin, window.width, r.centre_x),
                                                  furthest(window.y_begin, window.height, r.centre_y));
    // The steepest phase, `slope`, displaces light to v = slope on the film; beyond v = slope + 30, hardly
    // any light arrives. The computed field is periodic. It must be wide enough to keep this light from
    // wrapping around into the window.
    const double field_v = std::max(2 * pi * cells, window_v + std::max(window_v, slope + 30));
    if (field_v / s.v_step > 1 << 20) {
        fail(ExitCode::out_of_memory,
             "diffraction by Fourier optics needs {:.3g} MB of memory ({} MB are free)",
             std::pow(field_v / s.v_step, 2) * 3 * sizeof(double) / 1e6,
             available_memory_bytes() / 1'000'000);
    }
    s.size = next_smooth_even(field_v / s.v_step);
    s.cells = s.size * s.v_step / (2 * pi);
    return s;
}

FourierField fourier_field(const FourierResponse& r, const FourierSampling& s) {
    require_memory(static_cast<std::uint64_t>(s.bytes()), "diffraction by Fourier optics");
    const auto size = static_cast<std::size_t>(s.size);
    const Array<Complex> field = allocate<Complex>(size * size);
    const double width = 1 / s.cells, area = width * width;
    const int reach = std::min(s.size / 2 - 1, static_cast<int>(std::ceil(s.cells)) + 1);
    std::vector<double> light(size);
    parallel_for(size, [&](std::size_t row) {
        Complex* const line = field.get() + row * size;
        std::fill(line, line + size, Complex(0));
        const int j = row < size / 2 ? static_cast<int>(row) : static_cast<int>(row) - s.size;
        if (std::abs(j) > reach) return;
        for (int i = -reach; i <= reach; ++i) {
            const Cell cell = cell_of(r, i * width, j * width, width);
            line[wrapped(i, s.size)] = cell.wave * (area / pi);
            light[row] += cell.light * area;
        }
    });
    FourierField out;
    out.light = std::accumulate(light.begin(), light.end(), 0.0);
    if (!(out.light > 0))
        fail(ExitCode::wrong_arguments, "aperture lets no light through (got no transmission)");
    transform([&] {
        // The sign of the kernel exp(+i v p) matches focus_geometry.h: for an object behind the focus, light
        // through lens point p lands at v = u p.
        return fftw_plan_dft_2d(s.size, s.size, raw(field.get()), raw(field.get()), FFTW_BACKWARD,
                                FFTW_ESTIMATE);
    });
    // Each pupil sample is the mean over one cell. This multiplies the field on the film by the cell's
    // Fourier transform, a sinc; the gain divides the intensity by the square of this sinc.
    std::vector<double> gain(size);
    for (std::size_t i = 0; i < size; ++i) {
        const double angle = pi * static_cast<double>(std::min(i, size - i)) / static_cast<double>(size);
        gain[i] = angle > 0 ? std::pow(angle / std::sin(angle), 2) : 1;
    }
    out.intensity.resize(size * size);
    parallel_for(size, [&](std::size_t row) {
        for (std::size_t i = 0; i < size; ++i) {
            out.intensity[row * size + i] = std::norm(field[row * size + i]) * gain[row] * gain[i];
        }
    });
    return out;
}

void fill_fourier_energy(const FourierResponse& r, ResponseGrid& grid) {
    const FourierSampling s = fourier_sampling(r, grid);
    FourierField field = fourier_field(r, s);
    const auto size = static_cast<std::size_t>(s.size), half = size / 2 + 1;
    const Array<Complex> transfer = allocate<Complex>(size * half);
    transform([&] {
        return fftw_plan_dft_r2c_2d(s.size, s.size, field.intensity.data(), raw(transfer.get()),
                                    FFTW_ESTIMATE);
    });
    // A pixel's energy is the intensity, convolved with the pixel's square, at the pixel's centre. The field
    // is shifted so that the centre of the first pixel is at sample (0, 0). The other centres are then at
    // samples, too, because pixels are samples_per_px samples apart.
    const double begin_x = grid.x_begin + 0.5 - r.centre_x, begin_y = grid.y_begin + 0.5 - r.centre_y;
    const auto factor = [&](int k, double begin_px) {
        const double angle = 2 * pi * k / s.size * s.samples_per_px;  // rad per px
        const double sinc = k == 0 ? 1 : std::sin(angle / 2) / (angle / 2);
        // At the Nyquist frequency of an even size, the Fourier transform of a real signal is real.
        if (2 * std::abs(k) == s.size) return Complex(sinc * std::cos(angle * begin_px));
        return std::polar(1.0, angle * begin_px) * sinc;
    };
    std::vector<Complex> along_x(half);
    for (std::size_t i = 0; i < half; ++i) along_x[i] = factor(static_cast<int>(i), begin_x);
    // The integral of I over the plane of v is 4 times the transmitted light (4 pi for the disc, as dE = I v
    // dv / 2). The inverse transform multiplies by N^2.
    const double per_pixel = r.v_per_px * r.v_per_px / (4 * field.light) / static_cast<double>(size * size);
    parallel_for(size, [&](std::size_t row) {
        const int k = row <= size / 2 ? static_cast<int>(row) : static_cast<int>(row) - s.size;
        const Complex along_y = factor(k, begin_y) * per_pixel;
        for (std::size_t i = 0; i < half; ++i) transfer[row * half + i] *= along_y * along_x[i];
    });
    transform([&] {
        return fftw_plan_dft_c2r_2d(s.size, s.size, raw(transfer.get()), field.intensity.data(),
                                    FFTW_ESTIMATE);
    });
    const auto step = static_cast<std::size_t>(s.samples_per_px);
    for (int j = 0; j < grid.height; ++j) {
        for (int i = 0; i < grid.width; ++i) {
            const std::size_t x = static_cast<std::size_t>(i) * step, y = static_cast<std::size_t>(j) * step;
            grid.at(i, j) = std::max(field.intensity[y * size + x], 0.0);
        }
    }
}

}  // namespace postlens
