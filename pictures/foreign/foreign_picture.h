// An image of another program, flat or deep. Each pixel is a stack of samples with colour, alpha and depth.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_camera.h"
#include "pictures/foreign/foreign_channels.h"
#include "pictures/image.h"

namespace postlens {

/// One sample of a pixel's stack, composited over the samples behind it ("over" [porter1984]). Colours are
/// premultiplied by alpha.
struct StackSample {
    float inverse_z = 0;  ///< 1 / depth along the axis, 1/m; 0: infinitely far
    float r = 0, g = 0, b = 0;
    float alpha = 1;       ///< 0..1
    std::uint32_t id = 0;  ///< of the surface; 0: the file states none
    /// Inverse depth, 1/m, from which the circle of confusion is computed instead of from `inverse_z`, for an
    /// object with a depth offset, for instance. Negative if there is no such depth (see spread_inverse_z).
    float moved_inverse_z = -1;
    bool holdout = false;    ///< hides samples behind it, but adds no colour or alpha
    std::uint16_t mask = 0;  ///< number, from 1, of the mask that cut this sample out; 0: none
    [[nodiscard]] float spread_inverse_z() const { return moved_inverse_z < 0 ? inverse_z : moved_inverse_z; }
};

/// A stack of samples counts as opaque if its transmittance is at most this, because alphas are rounded.
inline constexpr double opaque_transmittance = 1e-3;

/// Transmittance of the samples of a stack that are behind its last opaque sample. 0 if there are none,
/// because what an opaque sample hides is not known.
[[nodiscard]] double transmittance_behind(std::span<const StackSample> stack);

/// Converts a value of an id channel to an id. The id consists of the bits of the float, because the bits
/// distinguish both hashes and whole numbers. Zero of either sign and NaN become 0, which means no id.
[[nodiscard]] std::uint32_t surface_id(float value, bool whole);

/// A pixel that shows several surfaces: its Cryptomatte states this, or its depth is a mean of two depths.
struct MixedPixel {
    std::size_t pixel = 0;             ///< index of its stack
    std::size_t first = 0, count = 0;  ///< range in ForeignPicture::shares
};

struct SurfaceShare {
    std::uint32_t id = 0;  ///< 0: a surface without id, such as the sky
    float share = 0;       ///< of the pixel; the shares of a pixel add up to 1
    /// Inverse depth of this surface, 1/m; 0: infinitely far. Present only if depths, instead of ids,
    /// distinguish the surfaces.
    std::optional<float> inverse_z;
};

/// A repair that was necessary to use the image.
struct ForeignRepair {
    std::string code, text;
    double share = 0;  ///< of the pixels stored
};

struct ForeignPicture {
    int width = 0, height = 0;  ///< size of the raster, px: the display window without overscan
    /// The stored pixels are [x_begin, x_end) x [y_begin, y_end). They may extend beyond the raster on any
    /// side.
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<std::uint64_t> offsets{
        0};                            ///< start of each pixel's stack, row by row, and the end of the last
    std::vector<StackSample> samples;  ///< from near to far within each stack
    /// Pixels that show several surfaces, in ascending order, and the shares of these surfaces, the largest
    /// first. The sample of a mixed pixel has the id of the largest share. Shares below 1 % are omitted. Both
    /// lists are empty if the image has neither a Cryptomatte nor depths that are means of two depths.
    std::vector<MixedPixel> mixed;
    std::vector<SurfaceShare> shares;
    std::vector<std::string> masks;  ///< the files by which samples were divided (StackSample::mask)
    ForeignCamera camera;
    ForeignChannels channels;
    double pixel_aspect = 1;  ///< width of a pixel on the film, divided by its height
    bool deep = false;
    bool whole_ids = false;  ///< ids are the whole numbers of an id channel; false: the bits of floats
    std::vector<ForeignRepair> repairs;

    /// Height of a pixel on the film.
    [[nodiscard]] double pixel_pitch_mm() const { return camera.film_width_mm / width / pixel_aspect; }
    /// Index of a stored pixel.
    [[nodiscard]] std::size_t pixel_at(int x, int y) const {
        return static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
               static_cast<std::size_t>(x - x_begin);
    }
    [[nodiscard]] std::span<const StackSample> stack(int x, int y) const { return stack_of(pixel_at(x, y)); }
    /// The stack of the stored pixel with this index.
    [[nodiscard]] std::span<const StackSample> stack_of(std::size_t pixel) const {
        return std::span(samples).subspan(offsets[pixel], offsets[pixel + 1] - offsets[pixel]);
    }
    /// The sample at which the composited alpha of a stored pixel reaches one half. Null if alpha stays below
    /// one half.
    [[nodiscard]] const StackSample* seen_sample(int x, int y) const {
        double left = 1;
        for (const StackSample& s : stack(x, y)) {
            left *= 1 - static_cast<double>(s.alpha);
            if (left <= 0.5) return &s;
        }
        return nullptr;
    }
    [[nodiscard]] bool stores(int x, int y) const {
        return x >= x_begin && x < x_end && y >= y_begin && y < y_end;
    }
    /// The image of the display window, with the stack of each pixel composited. `alpha` is empty if all
    /// pixels are opaque. Throws Error(out_of_memory).
    [[nodiscard]] Image flattened() const;
    /// Whether all pixels of the display window are opaque.
    [[nodiscard]] bool is_opaque() const;
    /// Depth, m, at which the composited alpha of the stack at a raster position reaches one half. Infinity
    /// if alpha stays below one half. Throws Error(wrong_arguments) outside the stored pixels.
    [[nodiscard]] double depth_at(double x, double y) const;
};

/// Reads the channels that `choice` selects, in bands of rows.
/// - Depth: 0, 1e9 units and more, infinity and NaN mean that nothing was hit. So does a flat image without a
///   depth channel (warning "assumed"). If all finite depths are negative, their absolute values are used,
///   with a warning; if only some are negative, an error names a pixel. Filtered depths of flat images are
///   repaired (mend_filtered_depths, warning "repaired").
/// - Colour: values that are not finite are replaced by the mean of finite neighbours, in deep images by
///   black. Alpha is clamped to [0, 1]. Both repairs cause the warning "repaired".
/// - Volumes: overlapping deep samples are merged (tidy_volumes), then divided into slices within which the
///   circle of confusion varies little.
/// - Ids: see surface_id. Unusable ids are ignored, with the warning "ids".
/// Throws Error(invalid_input) and Error(out_of_memory).
[[nodiscard]] ForeignPicture read_foreign_picture(const std::filesystem::path& path,
                                                  const ForeignChoice& choice,
                                                  const ForeignCameraChoice& camera);

}  // namespace postlens
