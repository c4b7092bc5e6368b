// An image of another program, flat or deep. Each pixel has a stack: a list of samples with colour, alpha and
// depth.
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

/// One sample in the stack of a pixel, composited over the samples behind it ("over" [porter1984]). Colours
/// are premultiplied by alpha.
struct StackSample {
    float inverse_z = 0;  ///< 1 / depth along the axis, 1/m; 0 means infinitely far
    float r = 0, g = 0, b = 0;
    float alpha = 1;       ///< 0..1
    std::uint32_t id = 0;  ///< of the surface; 0 if the file states none
    /// Inverse depth, in 1/m, with which the sample is blurred, if it differs from its true inverse depth,
    /// for example because the user keeps an object in focus. A negative value means that the sample is
    /// blurred with `inverse_z`.
    float moved_inverse_z = -1;
    bool holdout = false;    ///< hides samples behind it, but adds no colour or alpha
    std::uint16_t mask = 0;  ///< number, from 1, of the mask that cut this sample out; 0 if none
    [[nodiscard]] float spread_inverse_z() const { return moved_inverse_z < 0 ? inverse_z : moved_inverse_z; }
};

/// A stack of samples transmits a fraction of the light that comes from behind it. If this fraction is at
/// most this limit, the stack counts as opaque. The limit is not 0, because the alphas in a file are rounded.
inline constexpr double opaque_transmittance = 1e-3;

/// Returns the fraction of the light from behind that a pixel's stack of samples transmits. If a sample is
/// opaque and others lie behind it, only these others count.
/// - is_nothing_behind: true if the scene behind the stack is known to be empty; an opaque stack then hides
///   nothing, so the result is 1 instead of 0
[[nodiscard]] double transmittance_behind(std::span<const StackSample> stack, bool is_nothing_behind);

/// Converts a value of an id channel to an id: the bits of `value`, as an integer if `whole` is true, or else
/// as a float. The floats 0, -0 and NaN become 0, which means no id.
[[nodiscard]] std::uint32_t surface_id(float value, bool whole);

/// A pixel that shows several surfaces. This is known either from its Cryptomatte, which states the objects
/// in the pixel, or because its depth was recognised as a mean of two surfaces' depths.
struct MixedPixel {
    std::size_t pixel = 0;             ///< index of the pixel's stack
    std::size_t first = 0, count = 0;  ///< range in ForeignPicture::shares
};

struct SurfaceShare {
    std::uint32_t id = 0;  ///< 0 for a surface without id, such as the sky
    float share = 0;       ///< fraction of the pixel; the fractions of a pixel add up to 1
    /// Inverse depth of this surface, in 1/m (0 for infinity). It is set if the surfaces of the pixel are
    /// distinguished by their depths, and empty if they are distinguished by their object ids.
    std::optional<float> inverse_z;
};

/// A repair that was needed to make the image usable.
struct ForeignRepair {
    std::string code, text;
    double share = 0;  ///< fraction of the stored pixels
};

struct ForeignPicture {
    int width = 0, height = 0;  ///< size of the raster, px: the display window without overscan
    /// The file stores the pixels [x_begin, x_end) x [y_begin, y_end), which may extend beyond the image.
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<std::uint64_t> offsets{
        0};  ///< first sample of each pixel's stack, row by row; end of the last stack
    std::vector<StackSample> samples;  ///< from near to far within each stack
    /// Pixels that show several surfaces, in ascending order. `shares` holds the fraction of the pixel that
    /// each surface covers, the largest first.
    std::vector<MixedPixel> mixed;
    std::vector<SurfaceShare> shares;
    /// For each pixel that the file stores: 1 if there is empty space behind the last of the pixel's samples,
    /// and 0 otherwise. The vector is empty if all values would be 0.
    std::vector<std::uint8_t> ends_in_nothing;
    std::vector<std::string> masks;  ///< mask files that cut samples out (StackSample::mask)
    ForeignCamera camera;
    ForeignChannels channels;
    double pixel_aspect = 1;  ///< width of a pixel on the film, divided by its height
    bool deep = false;
    bool whole_ids = false;  ///< ids are whole numbers of an id channel; otherwise the bits of floats
    std::vector<ForeignRepair> repairs;

    /// Returns the height of a pixel on the film.
    [[nodiscard]] double pixel_pitch_mm() const { return camera.film_width_mm / width / pixel_aspect; }
    /// Returns the index of a stored pixel.
    [[nodiscard]] std::size_t pixel_at(int x, int y) const {
        return static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
               static_cast<std::size_t>(x - x_begin);
    }
    [[nodiscard]] std::span<const StackSample> stack(int x, int y) const { return stack_of(pixel_at(x, y)); }
    /// Returns the stack of the stored pixel with this index.
    [[nodiscard]] std::span<const StackSample> stack_of(std::size_t pixel) const {
        return std::span(samples).subspan(offsets[pixel], offsets[pixel + 1] - offsets[pixel]);
    }
    /// True if empty space lies behind the pixel's samples. A background image may be visible there.
    [[nodiscard]] bool is_nothing_behind(std::size_t pixel) const {
        return !ends_in_nothing.empty() && ends_in_nothing[pixel] != 0;
    }
    /// Composites the samples of a pixel from near to far, and returns the one at which alpha reaches one
    /// half. Returns null if there is none.
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
    /// Composites the samples of each pixel, and returns the image. Its `alpha` is empty if all pixels are
    /// opaque. Throws Error(out_of_memory).
    [[nodiscard]] Image flattened() const;
    /// True if all stored pixels are opaque and no sample is a holdout (hides what is behind it, but has no
    /// colour).
    [[nodiscard]] bool is_opaque() const;
    /// Returns the depth of the pixel at (x, y), in metres. It is the depth of the sample at which the alpha
    /// of this and all nearer samples, composited, reaches one half. Returns infinity if no sample reaches
    /// it. Throws Error(wrong_arguments) outside the stored pixels.
    [[nodiscard]] double depth_at(double x, double y) const;
};

/// Reads the channels that `choice` selects, in bands of rows.
/// - Depth: a depth of 0, of 1e9 units or more, infinity or NaN means that nothing was hit. In a flat image
///   without a depth channel, nothing was hit (warning "assumed"). If all finite depths are negative, their
///   absolute values are used, with a warning. If only some are negative, this is an error. Filtered depths
///   of flat images are repaired (mend_filtered_depths, warning "repaired").
/// - Colour: values that are not finite are replaced by the mean of finite neighbours in flat images, and by
///   black in deep images. Alpha is clamped to [0, 1]. Both changes cause the warning "repaired".
/// - Volumes: overlapping volumes of deep images are made to follow each other (tidy_volumes). They are then
///   divided into slices within which the circle of confusion varies little.
/// - Ids: see surface_id. Unusable ids are ignored, with the warning "ids".
///
/// Throws Error(invalid_input) and Error(out_of_memory).
[[nodiscard]] ForeignPicture read_foreign_picture(const std::filesystem::path& path,
                                                  const ForeignChoice& choice,
                                                  const ForeignCameraChoice& camera);

}  // namespace postlens
