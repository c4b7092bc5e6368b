// What a chart has measured, and its file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"

namespace postlens {

/// Error of a picture above the noise of its reference; without a second reference, as it is. NaN: unknown.
struct ChartError {
    double psnr_db = 0;        ///< of encoded values
    bool is_bound = false;     ///< the error may be zero: `psnr_db` is the least it can be
    double least_psnr_db = 0;  ///< at two standard errors
    double greatest_psnr_db = 0;

    /// Root mean square of encoded values.
    [[nodiscard]] double rms() const;
};

struct ChartFigures {
    ChartError whole, affected;
    double relmse = 0, ssim = 0, flip = 0;  ///< against the first reference; relMSE above noise where known
};

/// A sample file that methods read.
struct ChartTrace {
    std::string name;
    std::vector<double> seconds;  ///< by round
    std::uint64_t records = 0, bytes = 0;
    [[nodiscard]] double median_s() const;
};

struct ChartPoint {
    std::string curve;            ///< method, and what its records lack where they are not the best ones
    std::string name;             ///< unique: curve and setting
    int amount = 0;               ///< K, M or samples per pixel; 0: has none
    std::string trace;            ///< name of the sample file; empty: rays
    std::vector<double> seconds;  ///< by round, without the trace
    /// By round, of a sweep: its first picture, reading included, and one more through another lens. Empty:
    /// shares nothing.
    std::vector<double> first_of_many_s, further_s;
    std::optional<ChartFigures> figures;
    double retraced_share = 0;
    std::vector<std::string> warnings;  ///< codes

    [[nodiscard]] bool is_rays() const { return trace.empty(); }
    [[nodiscard]] double median_s() const;
    /// Per picture, where one sample file serves so many: infinity for no end of them. In single calls or in
    /// a sweep, whatever takes less.
    [[nodiscard]] double seconds_each(const ChartTrace* from, double pictures) const;
};

struct ChartData {
    std::string key;  ///< of everything that decides what the points mean; other keys are other charts
    nlohmann::ordered_json about;  ///< scene, lens, machine, versions
    double affected_share = 0;
    std::optional<double> noise_rms;         ///< of one reference, encoded values
    std::optional<ChartError> record_floor;  ///< `image` against the pinhole limit of rays
    double pinhole_psnr_db = 0;
    double reference_s = 0;
    std::vector<ChartTrace> traces;
    std::vector<ChartPoint> points;

    [[nodiscard]] const ChartTrace* trace_of(const ChartPoint& point) const;
};

/// The middle one, or the mean of the two in the middle; NaN of none.
[[nodiscard]] double median(std::vector<double> values);

[[nodiscard]] ChartError chart_error(const PixelErrors& plain, const std::optional<NoiseFloor>& noise);
[[nodiscard]] ChartFigures chart_figures(const Comparison& comparison);

[[nodiscard]] nlohmann::ordered_json to_json(const ChartData& data);
/// Throws Error(invalid_input), naming `path`.
[[nodiscard]] ChartData chart_from_json(const std::string& text, const std::filesystem::path& path);

/// By point: settings, seconds (median, least, greatest), errors.
[[nodiscard]] std::string chart_csv(const ChartData& data);
/// The same for people, as Markdown.
[[nodiscard]] std::string chart_markdown(const ChartData& data);

}  // namespace postlens
