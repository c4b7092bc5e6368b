// How much light a shutter lets through while it is open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace postlens {

/// Transmission over the open time, 0 at the opening, 1 at the closing. Only its shape counts: pictures are
/// weighted means over time, so a curve of half the height gives the same picture.
class ShutterCurve {
  public:
    /// Open at once, closed at once.
    [[nodiscard]] static ShutterCurve box();
    /// Rises to the middle and falls again.
    [[nodiscard]] static ShutterCurve triangle();
    /// Linear between points (time, transmission). At least two points, times finite and growing (the first
    /// is the opening, the last the closing), transmissions finite, not negative and not all 0: else
    /// Error(invalid_input) that begins with `source`.
    [[nodiscard]] static ShutterCurve points(std::vector<std::pair<double, double>> points,
                                             const std::string& source);
    /// A text file of such points, two numbers a line; # begins a comment. Throws Error(invalid_input).
    [[nodiscard]] static ShutterCurve read(const std::filesystem::path& path);

    /// The share of the open time by which the share u of the light has come, 0 <= u <= 1: maps evenly spread
    /// numbers to instants that are as frequent as the shutter is open.
    [[nodiscard]] double time(double u) const;
    /// The inverse of `time`: the share of the light that has come by a share of the open time; 0 before the
    /// opening, 1 after the closing.
    [[nodiscard]] double light(double time) const;
    /// Light per unit of time at a share of the open time; its integral from 0 to 1 is 1.
    [[nodiscard]] double density(double time) const;
    /// The same for equal curves, and hardly ever for others.
    [[nodiscard]] std::uint64_t fingerprint() const;
    [[nodiscard]] bool is_box() const { return knots_.size() == 2 && knots_[0].density == knots_[1].density; }

  private:
    struct Knot {
        double time = 0, density = 0, light = 0;  // light: integral of the density up to here
    };
    std::vector<Knot> knots_;
};

}  // namespace postlens
