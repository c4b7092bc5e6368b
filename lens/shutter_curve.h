// Transmission of a shutter during the exposure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace postlens {

/// The transmittance of the shutter during the exposure. Time runs from 0 (opening) to 1 (closing). Only the
/// shape of the curve matters: an image is a weighted mean over time, so scaling the curve has no effect.
class ShutterCurve {
  public:
    /// Constant transmission.
    [[nodiscard]] static ShutterCurve box();
    /// Rises linearly to the middle of the exposure, then falls linearly.
    [[nodiscard]] static ShutterCurve triangle();
    /// Makes a curve by linear interpolation between points (time, transmittance). The first time is the
    /// opening of the shutter, and the last time is the closing. There must be at least two points, with
    /// finite and increasing times. Transmittances must be finite and not negative, and at least one must be
    /// positive. Otherwise throws Error(invalid_input) with a message that begins with `source`.
    [[nodiscard]] static ShutterCurve points(std::vector<std::pair<double, double>> points,
                                             const std::string& source);
    /// Reads the curve from a text file with two numbers (time, transmittance) per line. A # begins a
    /// comment. Throws Error(invalid_input).
    [[nodiscard]] static ShutterCurve read(const std::filesystem::path& path);

    /// Returns the time, 0 to 1, by which the fraction u (0 to 1) of the light has passed the shutter. If u
    /// is a uniform random number, the time has a probability density proportional to the transmittance.
    [[nodiscard]] double time(double u) const;
    /// Inverse of `time`. Returns the fraction of the light that has arrived at the given time. It is 0
    /// before the opening and 1 after the closing.
    [[nodiscard]] double light(double time) const;
    /// Returns the transmittance at a time, scaled so that its integral from 0 to 1 is 1.
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
