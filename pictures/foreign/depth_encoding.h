// Converts the values of a depth channel to distances.
#pragma once

namespace postlens {

/// Encoding of a depth channel, where v is the value in the file and z the distance in the file's unit. at_0
/// and at_1 are the distances for v = 0 and v = 1.
///   distance    z = v
///   inverse     z = 1 / v
///   normalized  z = at_0 + v (at_1 - at_0)
struct DepthEncoding {
    enum class Kind { distance, inverse, normalized };
    Kind kind = Kind::distance;
    double at_0 = 0, at_1 = 1;

    /// Converts a depth value of the file, which is encoded as `kind` states, to a distance in the file's
    /// unit. The results 0 and infinity mean that the pixel shows no surface.
    [[nodiscard]] float distance(float value) const {
        switch (kind) {
            case Kind::distance:
                return value;
            case Kind::inverse:
                return 1 / value;
            case Kind::normalized:
                return static_cast<float>(at_0 + static_cast<double>(value) * (at_1 - at_0));
        }
        return value;
    }
};

}  // namespace postlens
