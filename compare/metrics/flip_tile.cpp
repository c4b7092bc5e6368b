#include "compare/metrics/flip_tile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/metrics/fast_math.h"
#include "core/multiversion.h"

// Tells the compiler that the arrays in the next loop do not overlap in memory. The compiler can vectorise
// the loop only if it knows this. It usually checks it by comparing addresses, but here there are too many
// arrays for such a check.
#if defined(__clang__)
#define POSTLENS_PLANES_DO_NOT_OVERLAP _Pragma("clang loop vectorize(assume_safety)")
#else
#define POSTLENS_PLANES_DO_NOT_OVERLAP _Pragma("GCC ivdep")
#endif

namespace postlens {
namespace {

constexpr double pi = 3.14159265358979323846;

// Coefficients of the tone curve of [narkowicz2016], which approximates the ACES tone curve by a quotient of
// two polynomials: n for the numerator and d for the denominator. The argument is multiplied by 0.6, so that
// both curves show the same exposure equally bright.
constexpr double tone_n2 = 0.6 * 0.6 * 2.51, tone_n1 = 0.6 * 0.03;
constexpr double tone_d2 = 0.6 * 0.6 * 2.43, tone_d1 = 0.6 * 0.59, tone_d0 = 0.14;

// Returns the weights of a filter that reaches `radius` px to either side of its centre. Each weight is the
// value of `function` at the signed distance from the centre, in px.
template <typename Function>
std::vector<double> taps_of(int radius, const Function& function) {
    std::vector<double> taps;
    for (int k = -radius; k <= radius; ++k) taps.push_back(function(static_cast<double>(k)));
    return taps;
}

// Scales the taps of a filter so that positive ones sum to `share`, and negative ones to -share. If the
// results of several filters are added, `share` is this filter's weight.
TileChannel normalised(const std::vector<double>& taps, double share = 1) {
    double positive = 0, negative = 0;
    for (const double t : taps) (t > 0 ? positive : negative) += std::abs(t);
    TileChannel out;
    for (const double t : taps) {
        const double scale = t > 0 ? share / positive : t < 0 ? share / negative : 0;
        out.push_back(static_cast<float>(scale * t));
    }
    return out;
}

double sum_of(const std::vector<double>& taps) {
    double sum = 0;
    for (const double t : taps) sum += t;
    return sum;
}

}  // namespace

FlipFilters::FlipFilters(double pixels_per_degree) {
    // FLIP filters each opponent colour channel by the contrast sensitivity of the eye. The filter is a
    // Gaussian a sqrt(pi/b) exp(-pi^2 x^2 / b), where x is the viewing angle in degrees. For the blue-yellow
    // channel, it is the sum of two Gaussians, with a1, b1 and a2, b2 [andersson2020, table 1 and eq. 4].
    constexpr double b_achromatic = 0.0047, b_red_green = 0.0053;
    constexpr double a1 = 34.1, b1 = 0.04, a2 = 13.5, b2 = 0.025;
    // Width, in degrees, of the filters by which FLIP finds edges and points [andersson2020, sec. 4.2]. It is
    // the distance from the peak to the trough of the edge filter, the derivative of a Gaussian.
    constexpr double detector_width = 0.082;
    const double sigma = 0.5 * detector_width * pixels_per_degree;
    const auto colour_radius =
        static_cast<int>(std::ceil(3 * std::sqrt(b1 / (2 * pi * pi)) * pixels_per_degree));
    const auto feature_radius = static_cast<int>(std::ceil(3 * sigma));
    radius = std::max(colour_radius, feature_radius);

    const auto gaussian = [&](double b) {
        return taps_of(radius, [&, b](double k) {
            const double x = k / pixels_per_degree;
            return std::abs(k) <= colour_radius ? std::exp(-pi * pi * x * x / b) : 0.0;
        });
    };
    achromatic = normalised(gaussian(b_achromatic));
    red_green = normalised(gaussian(b_red_green));
    const std::vector<double> wide = gaussian(b1), narrow = gaussian(b2);
    const double share1 = a1 * std::sqrt(pi / b1) * sum_of(wide) * sum_of(wide);
    const double share2 = a2 * std::sqrt(pi / b2) * sum_of(narrow) * sum_of(narrow);
    blue_yellow_1_row = normalised(wide);
    blue_yellow_1_column = normalised(wide, share1 / (share1 + share2));
    blue_yellow_2_row = normalised(narrow);
    blue_yellow_2_column = normalised(narrow, share2 / (share1 + share2));

    const auto detector = [&](const auto& factor) {
        return normalised(taps_of(radius, [&](double k) {
            return std::abs(k) <= feature_radius ? factor(k) * std::exp(-k * k / (2 * sigma * sigma)) : 0.0;
        }));
    };
    gauss = detector([](double) { return 1.0; });
    edge = detector([](double k) { return -k; });
    point = detector([sigma](double k) { return k * k / (sigma * sigma) - 1; });
}

FlipDisplay FlipDisplay::at_exposure(double stops) {
    FlipDisplay out;
    // An exposure of `stops` multiplies the light by 2^stops. The clamp keeps this factor within the range of
    // a float.
    out.scale_ = static_cast<float>(std::exp2(std::clamp(stops, -120.0, 120.0)));
    out.n2_ = static_cast<float>(tone_n2);
    out.n1_ = static_cast<float>(tone_n1);
    out.d2_ = static_cast<float>(tone_d2);
    out.d1_ = static_cast<float>(tone_d1);
    out.d0_ = static_cast<float>(tone_d0);
    return out;
}

double flip_tone_curve_inverse(double level) {
    // Solves tone curve(x) = `level` for x. The tone curve is a quotient of two quadratic polynomials.
    // Multiplying by its denominator gives the quadratic equation a x^2 + b x + c = 0, whose positive root is
    // returned.
    const double a = tone_n2 - level * tone_d2, b = tone_n1 - level * tone_d1, c = -level * tone_d0;
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

namespace {

// The matrices convert linear Rec.709 to X, Y, Z and back [iec61966-2-1]. X, Y, Z are divided by those of
// white (D65). So white becomes (1, 1, 1): the rows sum to 1.
constexpr float white_x = 0.9504559F, white_z = 1.0890578F;
constexpr std::array<float, 9> xyz_from_rgb{0.4123908F / white_x, 0.3575843F / white_x, 0.1804808F / white_x,
                                            0.2126390F,           0.7151687F,           0.0721923F,
                                            0.0193308F / white_z, 0.1191948F / white_z, 0.9505322F / white_z};
constexpr std::array<float, 9> rgb_from_xyz{3.2409699F * white_x,  -1.5373832F, -0.4986108F * white_z,
                                            -0.9692436F * white_x, 1.8759675F,  0.0415551F * white_z,
                                            0.0556301F * white_x,  -0.2039770F, 1.0569715F * white_z};

struct Colour {
    float x, y, z;
};

inline Colour times(const std::array<float, 9>& m, Colour c) {
    return {m[0] * c.x + m[1] * c.y + m[2] * c.z, m[3] * c.x + m[4] * c.y + m[5] * c.z,
            m[6] * c.x + m[7] * c.y + m[8] * c.z};
}

inline float lab_curve(float t) {
    constexpr float delta = 6.0F / 29;
    return t > delta * delta * delta ? cube_root(t) : t / (3 * delta * delta) + 4.0F / 29;
}

// Returns L*a*b*, with a and b scaled for the Hunt effect [andersson2020, sec. 4.1.2].
inline Colour hunt_lab(Colour rgb) {
    const Colour c = times(xyz_from_rgb, rgb);
    const float fx = lab_curve(c.x), fy = lab_curve(c.y), fz = lab_curve(c.z);
    const float lightness = 116 * fy - 16;
    return {lightness, 0.01F * lightness * 500 * (fx - fy), 0.01F * lightness * 200 * (fy - fz)};
}

// Returns the HyAB distance to the power 0.7 [andersson2020, sec. 4.1.3].
inline float colour_distance(Colour a, Colour b) {
    const float da = a.y - b.y, db = a.z - b.z;
    return power(std::abs(a.x - b.x) + std::sqrt(da * da + db * db), 0.7F);
}

inline float clamp01(float v) {
    return std::min(std::max(v, 0.0F), 1.0F);
}

// A tile after FLIP's filters: its colours in L*a*b*, and how strongly FLIP's detectors respond to edges and
// points at each pixel.
struct Seen {
    TileChannel lightness, a, b, edges, points;
    Seen()
        : lightness(tile_width * tile_height),
          a(lightness.size()),
          b(lightness.size()),
          edges(lightness.size()),
          points(lightness.size()) {}
};

// Buffers for one tile, reused for the next image and exposure.
struct Scratch {
    explicit Scratch(int radius) : rows(tile_height + 2 * radius), row_length(tile_width + 2 * radius) {
        const auto in_size = static_cast<std::size_t>(rows) * static_cast<std::size_t>(row_length);
        for (TileChannel& p : in) p.resize(in_size);
        half.resize(static_cast<std::size_t>(rows) * tile_width);
        for (TileChannel& p : out) p.resize(tile_width * tile_height);
    }
    int rows, row_length;
    std::array<TileChannel, 3> in;  // luminance, X - Y, Y - Z
    TileChannel half;
    std::array<TileChannel, 8> out;
};

using Tile = std::array<TileChannel, 3>;  // red, green, blue

void load(const Image& image, const PixelMask& usable, int x0, int y0, int radius, Tile& to) {
    const int rows = tile_height + 2 * radius, row_length = tile_width + 2 * radius;
    for (TileChannel& p : to) p.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(row_length));
    std::size_t i = 0;
    for (int y = 0; y < rows; ++y) {
        const int py = std::clamp(y0 - radius + y, 0, image.height - 1);
        for (int x = 0; x < row_length; ++x, ++i) {
            const int px = std::clamp(x0 - radius + x, 0, image.width - 1);
            const float* p = image.pixel(px, py);
            const bool counts = usable[static_cast<std::size_t>(p - image.rgb.data()) / 3] != 0;
            for (std::size_t c = 0; c < 3; ++c) to[c][i] = counts ? p[c] : 0.0F;
        }
    }
}

POSTLENS_MULTIVERSION
void to_opponent(const Tile& tile, const FlipDisplay& display, Scratch& s) {
    const float* const r = tile[0].data();
    const float* const g = tile[1].data();
    const float* const b = tile[2].data();
    float* const luminance = s.in[0].data();
    float* const red_green = s.in[1].data();
    float* const blue_yellow = s.in[2].data();
    const std::size_t size = s.in[0].size();
    POSTLENS_PLANES_DO_NOT_OVERLAP
    for (std::size_t i = 0; i < size; ++i) {
        const Colour c = times(xyz_from_rgb, {display(r[i]), display(g[i]), display(b[i])});
        luminance[i] = c.y;
        red_green[i] = c.x - c.y;
        blue_yellow[i] = c.y - c.z;
    }
}

POSTLENS_MULTIVERSION
void to_seen(const std::array<TileChannel, 8>& filtered, Seen& to) {
    const std::array<const float*, 8> f{filtered[0].data(), filtered[1].data(), filtered[2].data(),
                                        filtered[3].data(), filtered[4].data(), filtered[5].data(),
                                        filtered[6].data(), filtered[7].data()};
    float* const lightness = to.lightness.data();
    float* const a = to.a.data();
    float* const b = to.b.data();
    float* const edges = to.edges.data();
    float* const points = to.points.data();
    POSTLENS_PLANES_DO_NOT_OVERLAP
    for (std::size_t i = 0; i < tile_width * tile_height; ++i) {
        const float y = f[0][i];
        const Colour rgb = times(rgb_from_xyz, {y + f[1][i], y, y - (f[2][i] + f[3][i])});
        const Colour lab = hunt_lab({clamp01(rgb.x), clamp01(rgb.y), clamp01(rgb.z)});
        lightness[i] = lab.x;
        a[i] = lab.y;
        b[i] = lab.z;
        edges[i] = std::sqrt(f[4][i] * f[4][i] + f[5][i] * f[5][i]);
        points[i] = std::sqrt(f[6][i] * f[6][i] + f[7][i] * f[7][i]);
    }
}

void see(const Tile& tile, const FlipDisplay& display, const FlipFilters& filters, Scratch& s, Seen& to) {
    to_opponent(tile, display, s);
    const auto filter = [&](const TileChannel& in, const TileChannel& row, const TileChannel& column,
                            TileChannel& out) {
        filter_rows(in, s.rows, row, s.half);
        filter_columns(s.half, column, out);
    };
    filter(s.in[0], filters.achromatic, filters.achromatic, s.out[0]);
    filter(s.in[1], filters.red_green, filters.red_green, s.out[1]);
    filter(s.in[2], filters.blue_yellow_1_row, filters.blue_yellow_1_column, s.out[2]);
    filter(s.in[2], filters.blue_yellow_2_row, filters.blue_yellow_2_column, s.out[3]);
    // To find edges and points along columns, FLIP first blurs the rows with a Gaussian. The blurred image
    // `s.half` is the same for both, so it is computed once.
    filter_rows(s.in[0], s.rows, filters.gauss, s.half);
    filter_columns(s.half, filters.edge, s.out[5]);
    filter_columns(s.half, filters.point, s.out[7]);
    filter(s.in[0], filters.edge, filters.gauss, s.out[4]);
    filter(s.in[0], filters.point, filters.gauss, s.out[6]);
    to_seen(s.out, to);
}

// Computes the FLIP error of each pixel at one exposure [andersson2020, sec. 4.1.3, 4.2, 4.3]. `p` and `q`
// are the same tile of the two compared images. `errors` contains the largest error over the exposures
// computed so far, so it is replaced where the new error is larger.
POSTLENS_MULTIVERSION
void raise_errors(const Seen& p, const Seen& q, TileChannel& errors) {
    // `greatest` is the greatest colour distance, which is that of green and blue. FLIP maps colour distances
    // to colour errors from 0 to 1 by two straight lines. They meet at the distance `knee`, 0.4 times the
    // greatest. There, the error is 0.95.
    const float greatest = colour_distance(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1}));
    const float knee = 0.4F * greatest;
    const float slope1 = 0.95F / knee, slope2 = 0.05F / (greatest - knee);
    const std::array<const float*, 5> f{p.lightness.data(), p.a.data(), p.b.data(), p.edges.data(),
                                        p.points.data()};
    const std::array<const float*, 5> g{q.lightness.data(), q.a.data(), q.b.data(), q.edges.data(),
                                        q.points.data()};
    float* const out = errors.data();
    POSTLENS_PLANES_DO_NOT_OVERLAP
    for (std::size_t i = 0; i < tile_width * tile_height; ++i) {
        const float distance = colour_distance({f[0][i], f[1][i], f[2][i]}, {g[0][i], g[1][i], g[2][i]});
        const float colour = distance < knee ? slope1 * distance : 0.95F + slope2 * (distance - knee);
        const float feature = std::max(std::abs(f[3][i] - g[3][i]), std::abs(f[4][i] - g[4][i]));
        const float exponent = std::max(0.0F, 1 - std::sqrt(0.707106781F * feature));
        const float error = power(colour, exponent), before = out[i];
        out[i] = error > before ? error : before;
    }
}

}  // namespace

void flip_errors(const Image& reference, const Image& test, const PixelMask& usable,
                 const std::vector<FlipDisplay>& displays, std::vector<float>& map) {
    const FlipFilters filters(flip_pixels_per_degree);
    const int width = reference.width, height = reference.height;
    map.assign(usable.size(), 0.0F);
    for_each_tile(width, height, [&](int x0, int y0) {
        Tile a, b;
        load(reference, usable, x0, y0, filters.radius, a);
        load(test, usable, x0, y0, filters.radius, b);
        if (a == b) return;  // the errors are 0, which `map` already contains
        Scratch scratch(filters.radius);
        Seen seen_a, seen_b;
        TileChannel errors(tile_width * tile_height, 0.0F);
        for (const FlipDisplay& display : displays) {
            see(a, display, filters, scratch, seen_a);
            see(b, display, filters, scratch, seen_b);
            raise_errors(seen_a, seen_b, errors);
        }
        const int w = std::min(tile_width, width - x0);
        for (int y = 0; y < std::min(tile_height, height - y0); ++y) {
            std::copy_n(errors.begin() + y * tile_width, w,
                        map.begin() + static_cast<std::ptrdiff_t>(y0 + y) * width + x0);
        }
    });
}

}  // namespace postlens
