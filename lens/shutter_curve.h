// Transmission of a shutter during the exposure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace postlens {

/// The shutter's transmittance during the exposure. Time runs from 0 (opening) to 1 (closing). Scaling the
/// curve has no effect, because images are weighted means over time.
class ShutterCurve {
  public:
    /// Constant transmission.
    [[nodiscard]] static ShutterCurve box();
    /// Rises linearly to the middle of the exposure, then falls linearly.
    [[nodiscard]] static ShutterCurve triangle();
    /// Makes a curve by linear interpolation between points (time, transmittance), from the opening of the
    /// shutter to its closing.
    ///
    /// Throws Error(invalid_input), with a message that begins with `source`, unless there are two points or
    /// more, times increase, and transmittances are finite, not negative and not all 0.
    [[nodiscard]] static ShutterCurve points(std::vector<std::pair<double, double>> points,
                                             const std::string& source);
    /// Reads the curve from a text file. Each line contains two numbers, the time and the transmittance, for
    /// one point of the curve. A # begins a comment.
    ///
    /// Throws Error(invalid_input).
    [[nodiscard]] static ShutterCurve read(const std::filesystem::path& path);

    /// Returns the time (0: shutter opens, 1: closes) by which the fraction u of the exposure's light has
    /// passed. Uniform random u give times distributed by the transmittance.
    [[nodiscard]] double time(double u) const;
    /// Returns the fraction of the exposure's light that has passed the shutter until `time` (0: shutter
    /// opens, 1: closes). It is the inverse function of `time(u)`, but 0 before the opening and 1 after the
    /// closing.
    [[nodiscard]] double light(double time) const;
    /// Returns the shutter's transmittance at a time, scaled such that its integral is 1.
    [[nodiscard]] double density(double time) const;
    /// Hash of the curve.
    [[nodiscard]] std::uint64_t fingerprint() const;
    [[nodiscard]] bool is_box() const { return knots_.size() == 2 && knots_[0].density == knots_[1].density; }

  private:
    struct Knot {
        double time = 0, density = 0, light = 0;  // light: integral of density from 0 to time
    };
    std::vector<Knot> knots_;
};

}  // namespace postlens
