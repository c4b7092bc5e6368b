// Stores the measurements of a chart of speed against accuracy, and converts them to JSON, CSV and Markdown.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"

namespace postlens {

/// Error of a method's image against the reference image. If there is a second reference, the noise of the
/// references is measured by comparing them, and subtracted. Unknown values are NaN.
struct ChartError {
    double psnr_db = 0;        ///< PSNR of sRGB-encoded values, dB
    bool is_bound = false;     ///< the error may be zero, and `psnr_db` is a lower bound
    double least_psnr_db = 0;  ///< PSNR at two standard errors, dB
    double greatest_psnr_db = 0;

    /// Root mean square error of the sRGB-encoded values in [0, 1].
    [[nodiscard]] double rms() const;
};

struct ChartFigures {
    ChartError whole, affected;
    /// Errors against the first of two reference images. Only `relmse` is corrected for the reference's
    /// noise.
    double relmse = 0, ssim = 0, flip = 0;
};

/// A sample file that was traced for a chart, which compares the errors and times of several methods. Most
/// methods make their images from such a file. Therefore, their cost includes the time of tracing the file,
/// `seconds`.
struct ChartTrace {
    std::string name;
    std::vector<double> seconds;  ///< one value per round
    std::uint64_t records = 0, bytes = 0;
    [[nodiscard]] double median_s() const;
};

struct ChartPoint {
    /// Name of the point's curve in the plots, for example "lightfield, coarse": the method, and the sample
    /// file from which the images are made. For the most detailed sample file, which is the usual one, only
    /// the method is named.
    std::string curve;
    std::string name;             ///< unique name: curve and amount
    int amount = 0;               ///< depths K, views M or samples per pixel; 0 if there is no such setting
    std::string trace;            ///< name of the sample file; empty for rays
    std::vector<double> seconds;  ///< one value per round; the trace is not included
    /// Time per image, in seconds, if one command makes several images from the sample file (a sweep).
    /// `first_of_many_s` is the time of the first image, including reading the file. `further_s` is the time
    /// of each further image. Both are empty if not timed.
    std::vector<double> first_of_many_s, further_s;
    std::optional<ChartFigures> figures;
    double retraced_share = 0;
    std::vector<std::string> warnings;  ///< codes of the warnings

    [[nodiscard]] bool is_rays() const { return trace.empty(); }
    [[nodiscard]] double median_s() const;
    /// Returns the mean time per image, in s, if `pictures` images are made from one sample file, `from`. The
    /// time of tracing this file is divided among the images. It is not included if `from` is null.
    /// `pictures` may be infinite, and then the time of tracing does not count.
    [[nodiscard]] double seconds_each(const ChartTrace* from, double pictures) const;
};

struct ChartData {
    /// Only charts with equal keys (the same scene, view and reference) are comparable.
    std::string key;
    nlohmann::ordered_json about;  ///< scene, lens, machine, versions
    double affected_share = 0;
    std::optional<double> noise_rms;  ///< RMS noise of one reference, sRGB-encoded
    /// Error of the pinhole image that is made from the sample file, against a ray-traced pinhole image.
    /// Neither image is blurred, so this is the error of the file's samples alone.
    std::optional<ChartError> record_floor;
    double pinhole_psnr_db = 0;
    double reference_s = 0;
    std::vector<ChartTrace> traces;
    std::vector<ChartPoint> points;
    nlohmann::ordered_json part;  ///< ChartRequest::part; null if not a share

    [[nodiscard]] const ChartTrace* trace_of(const ChartPoint& point) const;
};

/// Returns the median: the mean of the two middle values if their number is even. NaN without values.
[[nodiscard]] double median(std::vector<double> values);

[[nodiscard]] ChartError chart_error(const PixelErrors& plain, const std::optional<NoiseFloor>& noise);
[[nodiscard]] ChartFigures chart_figures(const Comparison& comparison);

/// Converts to JSON, which has no NaN or infinity: NaN becomes null, infinity "inf" or "-inf".
[[nodiscard]] nlohmann::ordered_json exact_number(double value);
/// Inverse of exact_number.
[[nodiscard]] double number_from(const nlohmann::ordered_json& json);
[[nodiscard]] nlohmann::ordered_json to_json(const ChartError& error);
/// Inverse of to_json.
[[nodiscard]] ChartError error_from(const nlohmann::ordered_json& json);
[[nodiscard]] nlohmann::ordered_json to_json(const ChartData& data);
/// Inverse of to_json. Throws Error(invalid_input), whose message names the file `path`.
[[nodiscard]] ChartData chart_from_json(const std::string& text, const std::filesystem::path& path);

/// Returns a chart as CSV with one row per measurement: settings, seconds (median, least, greatest) and
/// errors.
[[nodiscard]] std::string chart_csv(const ChartData& data);
/// Returns a Markdown table with the columns of chart_csv.
[[nodiscard]] std::string chart_markdown(const ChartData& data);

}  // namespace postlens
