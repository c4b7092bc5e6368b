// Converts each sample (colour and depth) of another program's image to a quadrilateral, which can be drawn
// as seen from many lens points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "focus/foreign/behind_fill.h"
#include "focus/foreign/border_extension.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Returns whether samples of neighbouring pixels belong to one surface. Their ids must be equal or missing.
/// Their CoC radii must differ by less than a pixel or, above 16 px, by less than 1/16 of the radius.
[[nodiscard]] bool are_one_surface(const StackSample& a, const StackSample& b, const FocusGeometry& geometry);

/// A sample of an image, drawn as a quadrilateral that covers the sample's pixel and has a depth at each of
/// its four corners. A pixel may have several, one behind another.
struct Facet {
    /// Number of corners of a pixel. The corner at (x, y) has the index x + 2 y, where x and y are 0 or 1.
    static constexpr std::size_t corners = 4;
    std::array<float, corners> inverse_z{};  ///< at the corners of its pixel, 1/m
    StackSample sample;
    std::uint32_t layer = 0;  ///< number of samples in front of it in its pixel
    std::uint32_t seed = 0;   ///< random bits that decide whether the sample is opaque in a view
    bool beyond = false;      ///< lies beyond the border of the picture (BorderExtension)
};

/// The surfaces of an image as quadrilaterals, one for each sample, sorted by pixel. They include estimates
/// of surfaces that the image does not show, behind edges and beyond the image border. Neighbouring
/// quadrilaterals of one surface have equal depths at their common corners, so no gap opens between them.
class Facets {
  public:
    /// Makes the quadrilaterals of the image `p`.
    /// - `behind`: the estimated surface behind the visible one, for each pixel of `p`. If empty, no hidden
    ///   surfaces are drawn.
    /// - `border`: extends the surfaces of `p` beyond the image border
    /// - `geometry`: the lens, which decides whether neighbouring samples count as one surface
    Facets(const ForeignPicture& p, const std::vector<Behind>& behind, const BorderExtension& border,
           const FocusGeometry& geometry);

    int x_begin, y_begin, width, height;

    [[nodiscard]] std::span<const Facet> at(std::size_t pixel) const {
        return std::span(facets_).subspan(offsets_[pixel], offsets_[pixel + 1] - offsets_[pixel]);
    }
    [[nodiscard]] std::uint64_t first_of(std::size_t pixel) const { return offsets_[pixel]; }
    [[nodiscard]] const Facet& facet(std::uint64_t number) const { return facets_[number]; }
    /// Smallest and largest inverse depth in a row of pixels, in 1/m. They are infinity and -infinity if the
    /// row has no samples.
    [[nodiscard]] const std::pair<float, float>& range(int row) const {
        return ranges_[static_cast<std::size_t>(row)];
    }

  private:
    void add(std::size_t number, const StackSample& s, bool beyond);
    [[nodiscard]] const Facet* continued(const Facet& f, int x, int y) const;
    void join_neighbours();
    void join(Facet& f, int x, int y) const;
    void find_ranges();

    FocusGeometry geometry_;
    std::vector<Facet> facets_;
    std::vector<std::uint64_t> offsets_;
    std::vector<std::pair<float, float>> ranges_;
};

}  // namespace postlens
