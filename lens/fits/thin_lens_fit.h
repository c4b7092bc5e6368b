// Fits focal length F, f-number n and focus distance s to measured circles of confusion.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace postlens {

/// Measured depth of a scene point, and the measured diameter of its circle of confusion on the film.
struct CocPair {
    double distance_m = 0;  ///< > 0, infinity allowed
    double coc_mm = 0;      ///< >= 0
};

/// Reads lines "distance_m,coc_mm". The first line may be that heading. Empty lines and lines that begin with
/// # are ignored. Throws Error(invalid_input) with a message "FILE:LINE: ..".
[[nodiscard]] std::vector<CocPair> read_coc_pairs(const std::filesystem::path& path);

struct FittedNumber {
    double value = 0;
    /// Estimated from the residuals of the fit. Absent if the number was given, or if the data do not
    /// determine it. Also absent unless there are more pairs than fitted parameters.
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

/// Least-squares fit of c = F^2 |z - s| / (n z (s - F)) [potmesil1981, eq. 3] over F, n and s. Numbers given
/// in the request stay fixed. The data determine only two numbers, because c = K |1/s - 1/z| with K = V D
/// (film distance times aperture diameter). If neither F nor n is given, infinitely many solutions fit; the
/// one with F = 50 mm is returned, and `doubts` explains this. Throws Error(invalid_input) for fewer than two
/// different depths, and for data that no lens can produce (every CoC is 0, or K is negative). Throws
/// Error(wrong_arguments) for F or n out of range.
[[nodiscard]] ThinLensFit fit_thin_lens(std::span<const CocPair> pairs, const ThinLensFitRequest& request);

}  // namespace postlens
