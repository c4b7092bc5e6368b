// Converts the depths in another program's image to inverse depths (1/z, with z along the optical axis).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "pictures/foreign/depth_encoding.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

class ForeignDepths {
  public:
    /// Renderers write 1e9, 1e10 or infinity as the distance of pixels where no surface was hit.
    static constexpr float nothing_z = 1e9F;

    /// `encoding` is absent if the values are distances.
    explicit ForeignDepths(const std::optional<DepthEncoding>& encoding) : encoding_(encoding) {}

    [[nodiscard]] float distance(float value) const { return encoding_ ? encoding_->distance(value) : value; }
    /// True if `z`, a distance that is decoded from the file, is the distance of a surface. A distance of 0,
    /// NaN, or at least `nothing_z` means that the ray of this pixel hit no surface.
    [[nodiscard]] static bool is_hit(float z) { return std::abs(z) < nothing_z && z != 0; }
    [[nodiscard]] static float inverse_of(float z) { return is_hit(z) ? 1 / z : 0; }
    /// Decodes the depth `value`, which the file stores for pixel (x, y), to a distance z in the file's unit.
    /// Returns 1 / |z|, or 0 if no surface was hit.
    float inverse(float value, int x, int y) { return inverse(value, x, y, seen_); }
    /// Notes the sign and size of a depth, for checks in `finish` and for its warnings. `value` is the depth
    /// that the file stores for pixel (x, y), and `z` is the distance to which it was decoded, in the file's
    /// unit.
    void note(float z, int x, int y, float value) { seen_.note(z, x, y, value); }

    /// Sets the depths of the samples of a flat image. `depths` and `covered` contain the depths and alphas
    /// of its pixels in the file. Depths that a renderer filtered like colours (averaged at edges or
    /// multiplied by alpha) are repaired first.
    void take(const ForeignPart& part, std::vector<float>& depths, const std::vector<float>& covered,
              ForeignPicture& picture);
    /// Converts all depths to metres along the optical axis, and sorts each pixel's samples from near to far.
    /// Throws Error(invalid_input) if only some depths are negative.
    void finish(const ForeignFile& file, const ForeignPart& part, ForeignPicture& picture) const;

  private:
    struct Place {
        int x = 0, y = 0;
        float z = 0;
    };
    /// Statistics of decoded distances.
    struct Seen {
        float farthest = 0;        ///< largest finite depth, in the file's unit
        float greatest_value = 0;  ///< largest value of a depth in the file
        std::size_t negative = 0, positive = 0;
        Place first_negative;

        void note(float z, int x, int y, float value) {
            if (!is_hit(z)) return;
            farthest = std::max(farthest, std::abs(z));
            greatest_value = std::max(greatest_value, value);
            if (z < 0) {
                if (negative == 0) first_negative = {x, y, value};
                ++negative;
            } else {
                ++positive;
            }
        }
        /// Adds the statistics of pixels that follow.
        void add(const Seen& next) {
            farthest = std::max(farthest, next.farthest);
            greatest_value = std::max(greatest_value, next.greatest_value);
            if (negative == 0) first_negative = next.first_negative;
            negative += next.negative;
            positive += next.positive;
        }
    };
    float inverse(float value, int x, int y, Seen& seen) const {
        const float z = distance(value);
        seen.note(z, x, y, value);
        return inverse_of(std::abs(z));
    }
    /// Warns if the depths may be encoded in another way than assumed. If all distances are at most 1, they
    /// may be inverse or normalised depths. If depths that are declared as normalised exceed 1, they cannot
    /// be normalised.
    void warn_of_encoding(ForeignPicture& picture) const;

    std::optional<DepthEncoding> encoding_;
    Seen seen_;
};

}  // namespace postlens
