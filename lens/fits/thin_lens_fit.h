// Fits focal length F, f-number n and focus distance s to measured circles of confusion.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace postlens {

/// A scene point's measured depth and the diameter of its circle of confusion (CoC) on the film.
struct CocPair {
    double distance_m = 0;  ///< > 0, infinity allowed
    double coc_mm = 0;      ///< >= 0
};

/// Reads lines of the form "distance_m,coc_mm". The first line may be this heading. Empty lines and lines
/// that begin with # are ignored.
///
/// Throws Error(invalid_input) with a message "FILE:LINE: ..".
[[nodiscard]] std::vector<CocPair> read_coc_pairs(const std::filesystem::path& path);

struct FittedNumber {
    double value = 0;
    /// Standard error of `value`, estimated from the residuals of the fit. Absent if `value` was given and
    /// not fitted, if the data do not determine it, or if there are too few measurements.
    std::optional<double> standard_error;
};

struct ThinLensFit {
    FittedNumber focal_length_mm, f_number, focus_distance_m;
    double rms_mm = 0;  ///< root mean square of the residuals
    double condition =
        1;  ///< condition number of the Jacobian, columns scaled to 1: 1 is best, above 1e6 is useless
    std::vector<std::string> doubts;  ///< the numbers that the data do not determine, and why
};

struct ThinLensFitRequest {
    std::optional<double> focal_length_mm, f_number;  ///< known beforehand
};

/// Fits the focal length F, the f-number n and the focus distance s by least squares, such that c = F^2 |z -
/// s| / (n z (s - F)) [potmesil1981, eq. 3]. c is the CoC diameter and z the depth. Numbers given in the
/// request stay fixed.
///
/// The data determine only two of the three numbers, because c = K |1/s - 1/z| with K = V D (film distance
/// times aperture diameter). If neither F nor n is given, infinitely many solutions fit equally well. The
/// solution with F = 50 mm, or half the focus distance if that is shorter, is returned, and `doubts` explains
/// this.
///
/// Throws Error(invalid_input) if there are fewer than two different depths, or if no lens can produce the
/// data (every CoC is 0, or K is negative). Throws Error(wrong_arguments) if F or n is out of range.
[[nodiscard]] ThinLensFit fit_thin_lens(std::span<const CocPair> pairs, const ThinLensFitRequest& request);

}  // namespace postlens
