// The samples of another program's image as quadrilaterals, from which views are drawn.
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

/// Whether samples of neighbouring pixels belong to one surface: equal ids, or none, and CoC radii that
/// differ by less than a pixel, beyond 16 px by less than a 16th.
[[nodiscard]] bool are_one_surface(const StackSample& a, const StackSample& b, const FocusGeometry& geometry);

/// A sample of a pixel's stack as a quadrilateral with a depth at each corner.
struct Facet {
    /// Number of corners of a pixel. The corner at (x, y), where x and y are 0 or 1, has the index x + 2 y.
    static constexpr std::size_t corners = 4;
    std::array<float, corners> inverse_z{};  ///< at the corners of its pixel, 1/m
    StackSample sample;
    std::uint32_t layer = 0;  ///< number of samples in front of it in its pixel
    std::uint32_t seed = 0;   ///< random bits that make the sample opaque or transparent in a view
    bool beyond = false;      ///< continues beyond the border of the picture (BorderExtension)
};

/// The samples of an image, of the surfaces behind its edges and of what continues beyond its border, as
/// quadrilaterals sorted by pixel. Where neighbouring quadrilaterals continue one surface, their common
/// corners have the same depth.
class Facets {
  public:
    /// `behind`: one estimate per pixel, or empty. `border`: of the same picture.
    Facets(const ForeignPicture& p, const std::vector<Behind>& behind, const BorderExtension& border,
           const FocusGeometry& geometry);

    int x_begin, y_begin, width, height;

    [[nodiscard]] std::span<const Facet> at(std::size_t pixel) const {
        return std::span(facets_).subspan(offsets_[pixel], offsets_[pixel + 1] - offsets_[pixel]);
    }
    [[nodiscard]] std::uint64_t first_of(std::size_t pixel) const { return offsets_[pixel]; }
    [[nodiscard]] const Facet& facet(std::uint64_t number) const { return facets_[number]; }
    /// Smallest and largest inverse depth in a row of pixels; infinity and -infinity if the row has no
    /// sample.
    [[nodiscard]] const std::pair<float, float>& range(int row) const {
        return ranges_[static_cast<std::size_t>(row)];
    }

  private:
    /// `number`: of the pixel, for Facet::seed.
    void add(std::size_t number, const StackSample& s, bool beyond);
    /// Returns the sample in pixel (x, y) that continues the surface of `f`. Null if there is none.
    [[nodiscard]] const Facet* continued(const Facet& f, int x, int y) const;
    void join_neighbours();
    /// Sets the corner depths of `f` to the mean depth of the samples that continue its surface. Thread-safe,
    /// because corner depths of neighbours are not read.
    void join(Facet& f, int x, int y) const;
    void find_ranges();

    FocusGeometry geometry_;
    std::vector<Facet> facets_;
    std::vector<std::uint64_t> offsets_;
    std::vector<std::pair<float, float>> ranges_;
};

}  // namespace postlens
