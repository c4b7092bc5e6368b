// The sample record: one node (a surface hit) of the shading tree of one point sample.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace postlens {

/// The reflections and transmissions on the way from the eye to a node, two bits per bounce, the first bounce
/// in the lowest bits. 0 is the path of the primary node, the surface that the eye ray hits.
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
    /// The last bounce, by which the path reached this node; `none` for the primary node.
    [[nodiscard]] constexpr Bounce kind() const { return bits_ == 0 ? Bounce::none : bounce(depth() - 1); }
    [[nodiscard]] constexpr NodePath child(Bounce b) const {
        return NodePath(bits_ | (static_cast<std::uint32_t>(b) << (2 * depth())));
    }
    [[nodiscard]] constexpr NodePath parent() const {
        return bits_ == 0 ? NodePath() : NodePath(bits_ & ~(3U << (2 * (depth() - 1))));
    }
    /// False if a bounce has the reserved value 3, or if a bounce comes after an empty one.
    [[nodiscard]] constexpr bool valid() const {
        for (std::uint32_t b = bits_; b != 0; b >>= 2) {
            if ((b & 3U) == 0 || (b & 3U) == 3U) return false;
        }
        return true;
    }
    /// "primary", or one letter per bounce (R reflected, T transmitted), for example "RTT".
    [[nodiscard]] std::string text() const;

    friend constexpr bool operator==(NodePath, NodePath) = default;

  private:
    std::uint32_t bits_ = 0;
};

/// A 2x2 matrix in raster axes (x right, y down). The matrix W of a record, 1/m, describes how the image of
/// its node moves on the raster when the lens point moves. Rows are the direction in which the image moves,
/// columns the direction in which the lens point moves. W = (dX/dp)^-1 dX/dq for a point X of the ray, where
/// p is the ray's tangent at the pinhole and q the lens point. For surfaces seen directly or in flat mirrors,
/// W = I / z'. See docs/sample_file.md.
struct Mat2 {
    float xx = 0, xy = 0, yx = 0, yy = 0;
    friend constexpr bool operator==(const Mat2&, const Mat2&) = default;
    [[nodiscard]] static constexpr Mat2 isotropic(float v) { return {v, 0, 0, v}; }
};

/// Reasons why a record and its neighbours do not determine the radiance between them.
struct RecordMark {
    /// The surface's texture varies between this sample and its neighbours, although they are at the finest
    /// subdivision.
    static constexpr std::uint8_t fine_texture = 1;
    /// This sample and its neighbours, at the finest subdivision, show parts of one object that are not
    /// connected, so there may be a gap between them. Or a part of a mesh that none of them shows is between
    /// them.
    static constexpr std::uint8_t gap = 2;
    static constexpr std::uint8_t all = fine_texture | gap;
};

/// One node. r, g, b are scene-linear radiance times the throughput of the path to the node. So the radiance
/// of a point sample is the sum over its nodes.
struct Record {
    float x = 0, y = 0;  ///< raster position, px; pixel i covers [i, i+1)
    float z = 0;         ///< z', m; +infinity where nothing was hit
    float r = 0, g = 0, b = 0;
    std::uint32_t id = 0;  ///< object; 0 for nothing
    NodePath path;
    std::uint32_t layer = 0;  ///< 0: visible from the pinhole
    Mat2 w;
    /// Error, 1/m^2, of the first-order displacement -W q of the node's image at lens point q. At the rim of
    /// a lens of diameter D, the error is about (film distance / pixel pitch) w_bend (D / 2)^2 px. 0: W is
    /// exact, or its error was not measured. Infinity: other lens points do not see the node by this path.
    /// Stored with the precision of a half float.
    float w_bend = 0;
    std::uint8_t mark = 0;  ///< bits of RecordMark
    friend bool operator==(const Record&, const Record&) = default;
};

/// The records of rows [y_begin, y_end) and columns [x_begin, x_end) of pixels. Pixel (x, y) has the index k
/// = (y - y_begin) * width() + (x - x_begin). Its records are [offsets[k], offsets[k + 1]), sorted by layer,
/// y, x, path.
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
