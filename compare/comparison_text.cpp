#include "compare/comparison_text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>

namespace postlens {
namespace {

std::string decibels(double value) {
    if (std::isnan(value)) return "-";
    return std::isinf(value) ? "no error" : fmt::format("{:.2f} dB", value);
}

std::string number(double value) {
    return std::isnan(value) ? "-" : fmt::format("{:.4g}", value);
}

std::vector<std::string> row(std::string name, const PixelErrors& e) {
    return {std::move(name), decibels(e.psnr_db), number(e.rmse), number(e.relmse), number(e.relmse_trimmed)};
}

std::vector<std::string> row(std::string name, const Figures& f) {
    std::vector<std::string> cells = row(std::move(name), f.errors);
    cells.insert(cells.end(), {number(f.ssim), number(f.flip_ldr), number(f.flip_hdr)});
    return cells;
}

std::string share_text(double share) {
    return std::isnan(share) ? "-" : fmt::format("{:.1f} %", 100 * share);
}

// Returns a sentence that states up to three PSNRs: of the image against the reference, of the noise of the
// reference, and of the error of the image apart from this noise.
std::string noise_sentence(const char* what, const PixelErrors& errors, const NoiseFloor& noise,
                           bool image_is_a_reference) {
    std::string text = fmt::format("{}: {}; the reference itself is good to {}", what,
                                   decibels(errors.psnr_db), decibels(psnr_from_mse(noise.reference_mse)));
    const auto psnr = [](double rms) { return psnr_from_mse(rms * rms); };
    if (image_is_a_reference || std::isnan(noise.encoded.mse)) return text;
    const double least_db = psnr(noise.encoded.greatest_rms());
    if (noise.encoded.is_bound())
        return text + fmt::format("; above its noise at least {}", decibels(least_db));
    return text + fmt::format("; above its noise {} ({:.2f} to {:.2f} dB)",
                              decibels(psnr_from_mse(noise.encoded.mse)), least_db,
                              psnr(noise.encoded.least_rms()));
}

}  // namespace

TextTable figures_table(const Comparison& comparison) {
    TextTable out{{"", "PSNR", "RMSE", "relMSE", "trimmed", "SSIM", "FLIP LDR", "FLIP HDR"}};
    out.push_back(row("whole frame", comparison.whole));
    if (comparison.affected)
        out.push_back(row("affected " + share_text(*comparison.affected_share), *comparison.affected));
    if (comparison.pinhole) out.push_back(row("pinhole", *comparison.pinhole));
    if (comparison.pinhole_affected) out.push_back(row("pinhole, affected", *comparison.pinhole_affected));
    return out;
}

std::vector<std::string> comparison_notes(const Comparison& comparison) {
    std::vector<std::string> out;
    if (comparison.identical) out.emplace_back("image and reference are identical, bit for bit");
    if (comparison.noise) {
        out.push_back(noise_sentence("whole frame", comparison.whole.errors, *comparison.noise,
                                     comparison.image_is_a_reference));
    }
    if (comparison.affected_noise) {
        out.push_back(noise_sentence("affected", comparison.affected->errors, *comparison.affected_noise,
                                     comparison.image_is_a_reference));
    }
    const FlipExposures& e = comparison.exposures;
    out.push_back(fmt::format(
        "FLIP: {} counts, as the pictures {} 0..1; HDR at {} exposures from {:.2f} to {:.2f} stops",
        comparison.within_range ? "LDR" : "HDR", comparison.within_range ? "lie within" : "reach beyond",
        e.count, e.start, e.stop));
    return out;
}

std::string aligned(const TextTable& table) {
    std::vector<std::size_t> widths;
    for (const auto& row : table) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string out;
    for (const auto& row : table) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i)
            line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i])
                           : fmt::format("  {:>{}}", row[i], widths[i]);
        out += line + "\n";
    }
    return out;
}

}  // namespace postlens
