// The sample record. It describes one surface hit of an eye ray, or of its reflections and refractions.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace postlens {

/// The path from the eye to a node (a surface hit), as a sequence of reflections and transmissions. Each
/// bounce takes two bits, from the lowest on. The path of the primary hit is 0.
class NodePath {
  public:
    enum class Bounce : std::uint32_t { none = 0, reflected = 1, transmitted = 2 };
    static constexpr int max_bounces = 16;

    constexpr NodePath() = default;
    constexpr explicit NodePath(std::uint32_t bits) : bits_(bits) {}

    [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }
    /// Number of bounces; 0 for the primary node.
    [[nodiscard]] constexpr int depth() const {
        int n = 0;
        for (std::uint32_t b = bits_; b != 0; b >>= 2) ++n;
        return n;
    }
    [[nodiscard]] constexpr Bounce bounce(int i) const {
        return static_cast<Bounce>((bits_ >> (2 * i)) & 3U);
    }
    /// Returns how the light path reaches the recorded surface: by a reflection or by a transmission as its
    /// last bounce, or `none` if the eye ray hits the surface directly.
    [[nodiscard]] constexpr Bounce kind() const { return bits_ == 0 ? Bounce::none : bounce(depth() - 1); }
    [[nodiscard]] constexpr NodePath child(Bounce b) const {
        return NodePath(bits_ | (static_cast<std::uint32_t>(b) << (2 * depth())));
    }
    [[nodiscard]] constexpr NodePath parent() const {
        return bits_ == 0 ? NodePath() : NodePath(bits_ & ~(3U << (2 * (depth() - 1))));
    }
    /// Returns whether `whole` starts with all bounces of this path.
    [[nodiscard]] constexpr bool begins(NodePath whole) const {
        return bits_ == (whole.bits_ & ((std::uint64_t{1} << (2 * depth())) - 1));
    }
    /// A path has two bits per bounce: 1 is a reflection, 2 a transmission, 3 is reserved, and 0 marks the
    /// end of the path.
    [[nodiscard]] constexpr bool valid() const {
        for (std::uint32_t b = bits_; b != 0; b >>= 2) {
            if ((b & 3U) == 0 || (b & 3U) == 3U) return false;
        }
        return true;
    }
    /// Returns one letter per bounce of the light path (R for reflected, T for transmitted), for example
    /// "RTT". Without bounces, returns "primary".
    [[nodiscard]] std::string text() const;

    friend constexpr bool operator==(NodePath, NodePath) = default;

  private:
    std::uint32_t bits_ = 0;
};

/// A 2x2 matrix in raster axes (x to the right, y down). The matrix W of a record, in 1/m, has this type.
///
/// W describes how the image of a node (a surface hit) moves on the raster when the lens point moves. Its
/// rows are the components of the image's motion, and its columns are those of the lens point's motion. For a
/// surface that is seen directly or in a flat mirror, W is the identity matrix divided by the depth z'.
/// docs/sample_file.md defines W for all other nodes.
struct Mat2 {
    float xx = 0, xy = 0, yx = 0, yy = 0;
    friend constexpr bool operator==(const Mat2&, const Mat2&) = default;
    [[nodiscard]] static constexpr Mat2 isotropic(float v) { return {v, 0, 0, v}; }
};

/// Flags of a record (sample). They warn that interpolation between this sample and its neighbours may miss
/// detail.
struct RecordMark {
    /// The texture of the surface is finer than the samples. The colour changes between this sample and its
    /// neighbours, and the pixel was not divided further, because its quadtree has reached the limit of
    /// subdivision.
    static constexpr std::uint8_t fine_texture = 1;
    /// It is not known whether the surface continues between this sample and its neighbours. The rays may
    /// have missed something narrow there: a gap in the object, or another part of its mesh.
    static constexpr std::uint8_t gap = 2;
    static constexpr std::uint8_t all = fine_texture | gap;
};

/// One node (surface hit) of the shading tree of an eye ray. r, g and b are scene-linear radiance times the
/// throughput of the path. So their sum over all nodes is the radiance of the eye ray.
struct Record {
    float x = 0, y = 0;  ///< raster position, px; pixel i covers [i, i+1)
    float z = 0;         ///< z', path length along the optical axis, m; +infinity where nothing was hit
    float r = 0, g = 0, b = 0;
    std::uint32_t id = 0;  ///< number of the object; 0 where nothing was hit
    NodePath path;
    std::uint32_t layer = 0;  ///< 0 if the pinhole sees the surface
    Mat2 w;
    /// Error of the matrix `w`, in 1/m^2. `w` describes how the image of the surface moves with the lens
    /// point, as a linear map, but in curved mirrors and through glass, this motion is nonlinear. For a lens
    /// point R metres from the lens centre, the position is wrong by w_bend * R^2 * film distance / pixel
    /// pitch, in px. 0 if not measured. Infinite if other lens points see the surface by another sequence of
    /// reflections and refractions.
    float w_bend = 0;
    std::uint8_t mark = 0;  ///< bits of RecordMark
    friend bool operator==(const Record&, const Record&) = default;
};

/// A band of records (surface hits): those of the pixels in rows y_begin to y_end - 1 and columns x_begin to
/// x_end - 1. The records of the pixel with the index k = pixel(x, y) have the indices offsets[k] to
/// offsets[k + 1] - 1 in `records`, and are sorted by layer, then by y, x and path.
struct RecordBand {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<std::uint32_t> offsets{0};  ///< width() * height() + 1 entries
    std::vector<Record> records;

    [[nodiscard]] int width() const { return x_end - x_begin; }
    [[nodiscard]] int height() const { return y_end - y_begin; }
    [[nodiscard]] std::size_t pixel(int x, int y) const {
        return static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(width()) +
               static_cast<std::size_t>(x - x_begin);
    }
};

}  // namespace postlens
