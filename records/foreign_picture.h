// Another program's picture as stacks of samples, one stack for each pixel: colour, alpha and depth.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "records/foreign_camera.h"
#include "records/foreign_channels.h"
#include "records/image.h"

namespace postlens {

/// Lies over what follows it in its stack ("over" [porter1984]); colours are premultiplied.
struct StackSample {
    float inverse_z = 0;  ///< one over the depth along the axis, 1/m; 0: infinitely far
    float r = 0, g = 0, b = 0;
    float alpha = 1;       ///< 0..1
    std::uint32_t id = 0;  ///< of the surface; 0: the file does not say
};

/// An id from its channel: the bits, which tell hashes of names and whole numbers alike apart; 0, for none,
/// of a float that is zero of either sign or NaN.
[[nodiscard]] std::uint32_t surface_id(float value, bool whole);

/// A pixel that several surfaces share, as a Cryptomatte says, or its depth, a mean of theirs.
struct MixedPixel {
    std::size_t pixel = 0;             ///< number of its stack
    std::size_t first = 0, count = 0;  ///< of ForeignPicture::shares
};

struct SurfaceShare {
    std::uint32_t id = 0;  ///< 0: what has none, such as the sky
    float share = 0;       ///< of the pixel; those of a pixel add up to 1
    /// Where depths and not ids tell the surfaces apart: of this one, 1/m; 0: infinitely far.
    std::optional<float> inverse_z;
};

/// Something that was changed so that the picture could be used at all.
struct ForeignRepair {
    std::string code, text;
    double share = 0;  ///< of the pixels stored
};

struct ForeignPicture {
    int width = 0, height = 0;  ///< of the display window, px: the raster
    /// Pixels stored: [x_begin, x_end) by [y_begin, y_end), on the raster, which they may leave on any side.
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<std::uint64_t> offsets{0};  ///< of each pixel's stack, row by row; one more at the end
    std::vector<StackSample> samples;       ///< each stack nearest first
    /// Pixels of several surfaces, by growing number, and their shares, the greatest first: that one's id is
    /// the sample's. Empty without a Cryptomatte and means of depths. Shares below 1 % are left out.
    std::vector<MixedPixel> mixed;
    std::vector<SurfaceShare> shares;
    ForeignCamera camera;
    ForeignChannels channels;
    bool deep = false;
    std::vector<ForeignRepair> repairs;

    [[nodiscard]] double pixel_pitch_mm() const { return camera.film_width_mm / width; }
    [[nodiscard]] std::span<const StackSample> stack(int x, int y) const {
        const std::size_t i =
            static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
            static_cast<std::size_t>(x - x_begin);
        return std::span(samples).subspan(offsets[i], offsets[i + 1] - offsets[i]);
    }
    [[nodiscard]] bool stores(int x, int y) const {
        return x >= x_begin && x < x_end && y >= y_begin && y < y_end;
    }
    /// The display window's picture: every stack laid together. `alpha` is absent where all is opaque. Throws
    /// Error(out_of_memory).
    [[nodiscard]] Image flattened() const;
    /// Depth at which half of the light at a place of the raster is held back, m; infinity where none is.
    /// Throws Error(wrong_arguments) outside of what is stored.
    [[nodiscard]] double depth_at(double x, double y) const;
};

/// Reads what `choice` picks out, in bands. A depth of 0, of 1e9 units and more, infinity and NaN are nothing
/// hit, as are flat pixels without a depth channel (warned of as "assumed"). Negative depths, where all that
/// are finite are, are taken as distances (warned of); else they are refused with their place. Depths of flat
/// pictures that went through the pixel's filter are mended (mend_filtered_depths; "repaired"). Colours that
/// are not finite get the mean of the finite ones around them (deep samples: black), alphas beyond 0..1 are
/// cut off; both are warned of as "repaired". Deep samples from Z to ZBack become slices whose circles differ
/// by little; those that overlap are mixed (tidy_volumes). Ids are the bits of their channel; NaN and zero of
/// either sign are none. What is wrong about ids is warned of as "ids", and they are left aside. Throws
/// Error(invalid_input), Error(out_of_memory).
[[nodiscard]] ForeignPicture read_foreign_picture(const std::filesystem::path& path,
                                                  const ForeignChoice& choice,
                                                  const ForeignCameraChoice& camera);

}  // namespace postlens
