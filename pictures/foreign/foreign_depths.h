// Depths of another program's image: converts values of the file to inverse depths along the optical axis.
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
    /// Distances from here on mean that nothing was hit: renderers write 1e9, 1e10 or infinity.
    static constexpr float nothing_z = 1e9F;

    /// `encoding`: absent if the values are distances.
    explicit ForeignDepths(const std::optional<DepthEncoding>& encoding) : encoding_(encoding) {}

    [[nodiscard]] float distance(float value) const { return encoding_ ? encoding_->distance(value) : value; }
    /// Whether a distance is that of a surface. 0, NaN, and distances from `nothing_z` on mean that nothing
    /// was hit.
    [[nodiscard]] static bool is_hit(float z) { return std::abs(z) < nothing_z && z != 0; }
    /// Inverse of a distance; 0 where nothing was hit.
    [[nodiscard]] static float inverse_of(float z) { return is_hit(z) ? 1 / z : 0; }
    /// Converts a value at the pixel (x, y) of the file to the inverse of the distance's absolute value.
    /// Records the distance (note).
    float inverse(float value, int x, int y) {
        const float z = distance(value);
        note(z, x, y, value);
        return inverse_of(std::abs(z));
    }
    /// Records the sign and the size of the distance `z`, which came from `value` at the pixel (x, y) of the
    /// file, for `finish`.
    void note(float z, int x, int y, float value) {
        if (!is_hit(z)) return;
        farthest_ = std::max(farthest_, std::abs(z));
        greatest_value_ = std::max(greatest_value_, value);
        if (z < 0) {
            if (negative_ == 0) first_negative_ = {x, y, value};
            ++negative_;
        } else {
            ++positive_;
        }
    }

    /// Sets the depths of a flat image's samples from the file's values, one per pixel, after repairing
    /// filtered depths. `covered` is the alpha of each pixel.
    void take(const ForeignPart& part, std::vector<float>& depths, const std::vector<float>& covered,
              ForeignPicture& picture);
    /// Converts depths to metres along the axis, and sorts each stack from near to far. Throws
    /// Error(invalid_input) if only some depths are negative.
    void finish(const ForeignFile& file, const ForeignPart& part, ForeignPicture& picture) const;

  private:
    struct Place {
        int x = 0, y = 0;
        float z = 0;
    };
    /// Warns if all distances are at most 1: few scenes are that small, but other encodings of depth have
    /// this range. Also warns if values that should be normalized exceed 1.
    void warn_of_encoding(ForeignPicture& picture) const;

    std::optional<DepthEncoding> encoding_;
    float farthest_ = 0;        ///< largest finite depth, in the file's unit
    float greatest_value_ = 0;  ///< largest value of a depth in the file
    std::size_t negative_ = 0, positive_ = 0;
    Place first_negative_;
};

}  // namespace postlens
