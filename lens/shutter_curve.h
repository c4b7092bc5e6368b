// Transmission of a shutter during the exposure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace postlens {

/// Transmittance during the exposure, whose time runs from 0 (opening) to 1 (closing). Only the shape of the
/// curve matters: an image is a weighted mean over time, so scaling the curve has no effect.
class ShutterCurve {
  public:
    /// Constant transmission.
    [[nodiscard]] static ShutterCurve box();
    /// Rises linearly to the middle of the exposure, then falls linearly.
    [[nodiscard]] static ShutterCurve triangle();
    /// Linear interpolation between points (time, transmittance). Requires at least two points, finite and
    /// increasing times, and finite transmittances that are not negative and not all 0. The first time is the
    /// opening and the last the closing. Otherwise throws Error(invalid_input) with a message that begins
    /// with `source`.
    [[nodiscard]] static ShutterCurve points(std::vector<std::pair<double, double>> points,
                                             const std::string& source);
    /// Reads the curve from a text file with two numbers (time, transmittance) per line; # begins a comment.
    /// Throws Error(invalid_input).
    [[nodiscard]] static ShutterCurve read(const std::filesystem::path& path);

    /// Time, 0 to 1, at which the share u of the light has arrived, 0 <= u <= 1. Uniform random numbers u
    /// give instants whose density is the transmittance.
    [[nodiscard]] double time(double u) const;
    /// Inverse of `time`: the share of the light that has arrived at a time. 0 before the opening, 1 after
    /// the closing.
    [[nodiscard]] double light(double time) const;
    /// Transmittance at a time, normalised so that its integral from 0 to 1 is 1.
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
