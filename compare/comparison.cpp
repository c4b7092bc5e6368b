#include "compare/comparison.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "compare/metrics/ssim.h"
#include "core/counted.h"
#include "core/error.h"
#include "core/threads.h"

namespace postlens {
namespace {

bool same_bits(const Image& a, const Image& b) {
    return a.rgb.size() == b.rgb.size() &&
           std::memcmp(a.rgb.data(), b.rgb.data(), a.rgb.size() * sizeof(float)) == 0;
}

void check_size(const Image& a, const Image& b, const char* name) {
    if (a.width != b.width || a.height != b.height) {
        fail(ExitCode::invalid_input, "{}: size differs (got {}x{}; expected {}x{} as the reference has)",
             name, a.width, a.height, b.width, b.height);
    }
}

// Returns the number of counted pixels in which either image has a value outside 0..1.
std::size_t count_clipped(const Image& a, const Image& b, const PixelMask& mask) {
    const auto outside = [](const float* p) {
        return std::any_of(p, p + 3, [](float v) { return v < 0 || v > 1; });
    };
    const auto width = static_cast<std::size_t>(a.width);
    return static_cast<std::size_t>(sum_of_rows(a.height, [&](std::size_t y) {
        double clipped = 0;
        for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
            if (mask[i] != 0 && (outside(a.rgb.data() + 3 * i) || outside(b.rgb.data() + 3 * i)))
                clipped += 1;
        }
        return clipped;
    }));
}

struct Maps {
    std::vector<float> ssim, flip_ldr, flip_hdr;
};

Figures figures_of(const Picture& image, const Picture& reference, const Maps& maps, const PixelMask& mask) {
    const int width = image.linear.width;
    return {.errors = pixel_errors(image, reference, mask),
            .ssim = mean_over(maps.ssim, width, mask),
            .flip_ldr = mean_over(maps.flip_ldr, width, mask),
            .flip_hdr = mean_over(maps.flip_hdr, width, mask)};
}

void add_noise(const Picture& image, const Picture& reference, Image second, const PixelMask& mask,
               const PixelMask& affected, Comparison& out) {
    out.references_are_equal = same_bits(reference.linear, second);
    out.image_is_a_reference = out.identical || same_bits(image.linear, second);
    const Picture r2(std::move(second));
    const PixelMask finite = finite_pixels(r2.linear);
    out.nonfinite.second_reference = finite.size() - count(finite);
    if (out.references_are_equal) return;
    out.noise = noise_floor(image, reference, r2, both(mask, finite));
    if (out.affected) out.affected_noise = noise_floor(image, reference, r2, both(affected, finite));
}

}  // namespace

Comparison compare_pictures(CompareInput input) {
    check_size(input.image, input.reference, "image");
    if (input.pinhole) check_size(*input.pinhole, input.reference, "pinhole picture");
    if (input.second_reference) check_size(*input.second_reference, input.reference, "second reference");

    Comparison out;
    out.width = input.reference.width;
    out.height = input.reference.height;
    const Picture image(std::move(input.image)), reference(std::move(input.reference));
    out.identical = same_bits(image.linear, reference.linear);
    const PixelMask finite_image = finite_pixels(image.linear),
                    finite_reference = finite_pixels(reference.linear);
    const PixelMask mask = both(finite_image, finite_reference);
    const std::size_t used = count(mask);
    out.nonfinite.image = mask.size() - count(finite_image);
    out.nonfinite.reference = mask.size() - count(finite_reference);
    out.nonfinite.any = mask.size() - used;
    out.nonfinite.image_only = out.nonfinite.any - out.nonfinite.reference;
    const std::size_t clipped = count_clipped(image.linear, reference.linear, mask);
    out.within_range = clipped == 0;
    out.clipped_share = static_cast<double>(clipped) / static_cast<double>(std::max<std::size_t>(used, 1));

    Maps maps;
    maps.ssim = ssim_map(image.encoded, reference.encoded, mask);
    maps.flip_ldr = flip_map(reference.linear, image.linear, mask);
    out.exposures = flip_exposures(reference.linear, mask, input.flip_white_luminance);
    maps.flip_hdr = hdr_flip_map(reference.linear, image.linear, mask, out.exposures);
    out.whole = figures_of(image, reference, maps, mask);

    PixelMask affected;
    if (input.pinhole) {
        const Picture pinhole(std::move(*input.pinhole));
        const PixelMask finite = finite_pixels(pinhole.linear);
        out.nonfinite.pinhole = finite.size() - count(finite);
        const PixelMask usable = both(mask, finite);
        affected = affected_pixels(pinhole.encoded, reference.encoded, usable);
        out.affected = figures_of(image, reference, maps, affected);
        out.affected_share = static_cast<double>(count(affected)) / static_cast<double>(count(usable));
        out.pinhole = pixel_errors(pinhole, reference, usable);
        out.pinhole_affected = pixel_errors(pinhole, reference, affected);
    }
    if (input.second_reference)
        add_noise(image, reference, std::move(*input.second_reference), mask, affected, out);
    return out;
}

std::uint64_t comparison_bytes(ImageSize size, int pictures) {
    // Memory of a comparison, in bytes per pixel. Each image needs 25 bytes: its linear and its encoded
    // values (three floats each), and one byte of the mask. The rest is for three float maps, two arrays of
    // doubles, and the file reader's buffer (12 bytes).
    const std::uint64_t per_pixel = static_cast<std::uint64_t>(pictures) * 25 + 3 * 4 + 2 * 8 + 12;
    return static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height) * per_pixel;
}

std::vector<std::string> failed_limits(const Comparison& comparison, const CompareLimits& limits) {
    std::vector<std::string> out;
    const PixelErrors& errors = comparison.whole.errors;
    // The PSNR is NaN if no pixel was compared. `!(psnr >= limit)` reports a NaN as below the limit, and
    // `psnr < limit` would not.
    if (limits.least_psnr_db && !(errors.psnr_db >= *limits.least_psnr_db)) {
        out.push_back(
            fmt::format("PSNR is {:.3f} dB below the limit (got {:.3f} dB; expected {:g} dB or more)",
                        *limits.least_psnr_db - errors.psnr_db, errors.psnr_db, *limits.least_psnr_db));
    }
    const auto at_most = [&out](const char* name, const std::optional<double>& limit, double value) {
        if (!limit || value <= *limit) return;
        out.push_back(fmt::format("{} is {:.4g} above the limit (got {:.6g}; expected {:g} or less)", name,
                                  value - *limit, value, *limit));
    };
    at_most("relMSE", limits.greatest_relmse, errors.relmse);
    const double flip = comparison.flip(comparison.whole);
    at_most("FLIP", limits.greatest_flip, flip);
    const bool any = limits.least_psnr_db || limits.greatest_relmse || limits.greatest_flip;
    if (any && comparison.nonfinite.image_only > 0) {
        out.push_back(
            fmt::format("the image has NaN or infinity where the reference has not (got {}; expected 0)",
                        counted(comparison.nonfinite.image_only, "pixel")));
    }
    return out;
}

}  // namespace postlens
