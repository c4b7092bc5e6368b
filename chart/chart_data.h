// The measurements of a chart, and their JSON, CSV and Markdown forms.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"

namespace postlens {

/// Error of an image. The noise of the reference is subtracted if a second reference is known. NaN: unknown.
struct ChartError {
    double psnr_db = 0;        ///< PSNR of sRGB-encoded values, dB
    bool is_bound = false;     ///< the error may be zero; `psnr_db` is then a lower bound
    double least_psnr_db = 0;  ///< PSNR at two standard errors, dB
    double greatest_psnr_db = 0;

    /// Root mean square error of the sRGB-encoded values, which span [0, 1].
    [[nodiscard]] double rms() const;
};

struct ChartFigures {
    ChartError whole, affected;
    double relmse = 0, ssim = 0, flip = 0;  ///< against the first reference; noise is subtracted from relmse
};

/// A sample file that methods read, and the seconds that tracing it takes.
struct ChartTrace {
    std::string name;
    std::vector<double> seconds;  ///< one value per round
    std::uint64_t records = 0, bytes = 0;
    [[nodiscard]] double median_s() const;
};

struct ChartPoint {
    std::string curve;  ///< method; also the name of its sample file unless that is from best_trace
    std::string name;   ///< unique name: curve and amount
    int amount = 0;     ///< depths K, views M or samples per pixel; 0: the method has no such setting
    std::string trace;  ///< name of the sample file; empty for rays
    std::vector<double> seconds;  ///< one value per round, without the trace
    /// Seconds in a sweep, one value per round: of the first image, including the reading of the file, and of
    /// each further image, with another lens. Empty if the images of a sweep share no work.
    std::vector<double> first_of_many_s, further_s;
    std::optional<ChartFigures> figures;
    double retraced_share = 0;
    std::vector<std::string> warnings;  ///< codes of the warnings

    [[nodiscard]] bool is_rays() const { return trace.empty(); }
    [[nodiscard]] double median_s() const;
    /// Seconds per image if `pictures` images (may be infinite) share one sample file, including their share
    /// of the trace. Takes single calls or a sweep, whichever is faster.
    [[nodiscard]] double seconds_each(const ChartTrace* from, double pictures) const;
};

struct ChartData {
    std::string key;  ///< scene, view and reference; points of charts with different keys are not comparable
    nlohmann::ordered_json about;  ///< scene, lens, machine, versions
    double affected_share = 0;
    std::optional<double> noise_rms;         ///< RMS noise of one reference, sRGB-encoded
    std::optional<ChartError> record_floor;  ///< pinhole image of the records against rays
    double pinhole_psnr_db = 0;
    double reference_s = 0;
    std::vector<ChartTrace> traces;
    std::vector<ChartPoint> points;
    nlohmann::ordered_json part;  ///< ChartRequest::part; null: not a share

    [[nodiscard]] const ChartTrace* trace_of(const ChartPoint& point) const;
};

/// The median; the mean of the two middle values if their number is even; NaN if there are none.
[[nodiscard]] double median(std::vector<double> values);

[[nodiscard]] ChartError chart_error(const PixelErrors& plain, const std::optional<NoiseFloor>& noise);
[[nodiscard]] ChartFigures chart_figures(const Comparison& comparison);

[[nodiscard]] nlohmann::ordered_json to_json(const ChartData& data);
/// Inverse of to_json. Throws Error(invalid_input), which names `path`.
[[nodiscard]] ChartData chart_from_json(const std::string& text, const std::filesystem::path& path);

/// One row per point: settings, seconds (median, least, greatest), errors.
[[nodiscard]] std::string chart_csv(const ChartData& data);
/// Markdown table with the columns of chart_csv: one row per point.
[[nodiscard]] std::string chart_markdown(const ChartData& data);

}  // namespace postlens
