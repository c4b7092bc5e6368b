// F, n and s from measured circles of confusion.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace postlens {

/// A point at a depth, and the diameter of its image on the film, without a sign.
struct CocPair {
    double distance_m = 0;  ///< > 0, infinity allowed
    double coc_mm = 0;      ///< >= 0
};

/// Reads lines "distance_m,coc_mm", with or without that line as a heading; empty lines and lines that begin
/// with # are passed over. Throws Error(invalid_input) "FILE:LINE: ..".
[[nodiscard]] std::vector<CocPair> read_coc_pairs(const std::filesystem::path& path);

struct FittedNumber {
    double value = 0;
    /// From the scatter of the data about the fit. Absent where the number was given, where the data do not
    /// tell it, and where there are no more pairs than numbers.
    std::optional<double> standard_error;
};

struct ThinLensFit {
    FittedNumber focal_length_mm, f_number, focus_distance_m;
    double rms_mm = 0;  ///< of what the fit leaves
    double condition =
        1;  ///< of the fit's Jacobian, columns scaled to 1: 1 is best, more than 1e6 tells nothing
    std::vector<std::string> doubts;  ///< what the data cannot tell, and why
};

struct ThinLensFitRequest {
    std::optional<double> focal_length_mm, f_number;  ///< known beforehand
};

/// Least squares of c = F^2 |z - s| / (n z (s - F)) [potmesil1981, eq. 3] over F, n and s, those given held.
/// Such data tell two numbers only: c = K |1/s - 1/z| with K = V D. With neither F nor n given the fit is for
/// F = 50 mm, as one of many, and `doubts` says so. Throws Error(invalid_input) for fewer than two different
/// depths and for data that no lens has (no CoC other than 0, or a K below 0), Error(wrong_arguments) for F
/// or n out of range.
[[nodiscard]] ThinLensFit fit_thin_lens(std::span<const CocPair> pairs, const ThinLensFitRequest& request);

}  // namespace postlens
