// Transmission of a shutter during the exposure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace postlens {

/// Transmission over the exposure, whose time runs from 0 (opening) to 1 (closing). Only the shape matters:
/// an image is a weighted mean over time, so scaling the curve does not change it.
class ShutterCurve {
  public:
    /// Constant transmission.
    [[nodiscard]] static ShutterCurve box();
    /// Linear rise to the middle of the exposure, then linear fall.
    [[nodiscard]] static ShutterCurve triangle();
    /// Linear interpolation between points (time, transmission). Needs at least two points; finite, growing
    /// times, of which the first is the opening and the last the closing; and finite transmissions that are
    /// not negative and not all 0. Throws Error(invalid_input) otherwise, whose message begins with `source`.
    [[nodiscard]] static ShutterCurve points(std::vector<std::pair<double, double>> points,
                                             const std::string& source);
    /// Reads the points of `points` from a text file, two numbers per line; # begins a comment. Throws
    /// Error(invalid_input).
    [[nodiscard]] static ShutterCurve read(const std::filesystem::path& path);

    /// Time at which the share u of the light has arrived, 0 <= u <= 1. Maps uniformly distributed numbers to
    /// instants distributed as the transmission.
    [[nodiscard]] double time(double u) const;
    /// Inverse of `time`: share of the light that has arrived at a time; 0 before the opening, 1 after the
    /// closing.
    [[nodiscard]] double light(double time) const;
    /// Transmission at a time, normalised so that its integral from 0 to 1 is 1.
    [[nodiscard]] double density(double time) const;
    /// Hash of the curve.
    [[nodiscard]] std::uint64_t fingerprint() const;
    [[nodiscard]] bool is_box() const { return knots_.size() == 2 && knots_[0].density == knots_[1].density; }

  private:
    struct Knot {
        double time = 0, density = 0, light = 0;  // light: integral of the density up to here
    };
    std::vector<Knot> knots_;
};

}  // namespace postlens
