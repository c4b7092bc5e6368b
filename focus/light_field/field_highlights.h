// Blurs highlights (very bright light) with exact blur kernels, and tests for each part of the lens whether
// nearer surfaces hide a highlight from it. All other light is blurred in another way: many sharp images of
// the scene are drawn, each from another lens point, and averaged.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "focus/light_field/lens_views.h"
#include "focus/light_field/merged_highlights.h"
#include "focus/light_field/moving_highlights.h"
#include "focus/responses/kernel.h"
#include "focus/responses/response_model.h"
#include "focus/scatter/splat_tables.h"
#include "lens/aperture.h"
#include "reproject/patch_field.h"

namespace postlens {

/// Returns the rule that selects highlights to be spread by blur kernels. Other light is blurred as the mean
/// of images from a few lens points, in which a highlight would be visible as separate copies.
///
/// The rule selects no highlights if the kernel varies over the image or has spherical aberration, because
/// FieldHighlights supports neither.
[[nodiscard]] HighlightRule highlight_rule(const Aperture& aperture, const FocusGeometry& geometry);

/// Highlights (very bright light) that were removed from the recorded surfaces, because blur kernels spread
/// them separately.
///
/// A nearer surface may hide a highlight from a part of the lens. For the brightest static highlights that
/// are seen directly, this part is computed exactly, by projecting the nearer surfaces. For all other
/// highlights, the part follows from the views (images from single lens points): a lens point sees the
/// highlight if no nearer surface lies there in its view.
class FieldHighlights {
  public:
    /// Collects the highlights of recorded surfaces, and finds the blur kernel of each.
    /// - `sheets`: the recorded surfaces with their highlights; must outlive this object
    /// - `window`: the pixels of the image, as a part of the raster
    /// - `motion`: motion of the highlights; null if nothing moves
    FieldHighlights(const TreeSheets& sheets, const Aperture& aperture, const FocusGeometry& geometry,
                    const RasterWindow& window, const HighlightMotion* motion = nullptr);

    [[nodiscard]] bool any() const { return !sources_.empty(); }
    /// Returns an object that adds the blurred highlights to an image. This image is the mean of the views,
    /// the images from the lens points `views`. The object keeps references to `*this` and to `views`.
    /// - `set`: number of this set of lens points; it varies the pseudo-random numbers
    /// - `instants`: for each lens point, the instant of its view, as a fraction of the exposure; may be
    ///   empty if nothing moves
    [[nodiscard]] std::unique_ptr<Lights> over(const std::vector<LensViewPoint>& views, int set,
                                               const std::vector<double>& instants = {}) const;

    /// Chooses random rays through the pixel (x, y) and the lens to the highlights `sources`, and appends
    /// them to `lines`. If a sharp moving highlight passes next to the pixel, rays through the pixel are
    /// chosen for it, too. The sample file may lack parts of the highlight, and these may pass through the
    /// pixel. So such rays may miss.
    void aim(int x, int y, std::span<const std::uint32_t> sources, std::uint64_t seed, int count,
             std::vector<Lights::Line>& lines) const;
    /// Returns the indices of the light sources (merged highlights) whose blur may reach a rectangle of the
    /// image. (x, y) is the rectangle's upper left pixel. The rectangle must lie within one tile, a square of
    /// SeenTile::edge px.
    [[nodiscard]] std::vector<std::uint32_t> reaching(int x, int y, int width, int height) const;

  private:
    class OverViews;
    struct Source {
        int x = 0, y = 0;          ///< anchor of the kernel, image px
        std::uint32_t kernel = 0;  ///< index into kernels_, or into sharp_kernels_
        bool is_sharp = false;     ///< whether the kernel is in sharp_kernels_
        glm::dvec2 at{0};          ///< position, image px
        glm::dvec2 shift{0};       ///< of the centre of an almost sharp blur, px (inclination_shift_px)
        std::array<float, 3> rgb{};
        double light = 0;     ///< sum of rgb
        double area = 0;      ///< px^2
        double exposure = 1;  ///< share of the exposure for which this source's instant stands
        double square = 0;    ///< rgb times radiance, in the brightest channel
        glm::dmat2 lens_from_px{1}, px_from_lens{1};
        float inverse_z = 0;
        bool by_all = false;  ///< all views decide on visibility, not only those near one lens point
        double u = -1;        ///< fraction of the exposure passed at this instant; -1 if always present
        SheetKey key;
        std::uint32_t sheet = 0;
        std::uint32_t group = 0;                  ///< index into groups_
        std::uint32_t first_part = 0, parts = 0;  ///< elements of parts_
    };
    /// Neighbouring highlights whose visibility is computed together, at their centre.
    struct Group {
        Source middle;
        int column = 0, row = 0;  ///< position of the group's square in the grid of groups
        double light = 0;
        glm::dvec2 spread_px{0};                             ///< standard deviation of the sources' positions
        int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;  ///< image px that the kernels reach
    };
    /// Neighbouring highlights, `sources`, whose blur reaches a tile (square of the image). Whether nearer
    /// surfaces hide them is tested for all of them together, at `samples` positions in each pixel. If
    /// `samples` is 0, this test is not made. Then the images from single lens points, which have already
    /// been drawn for the tile, show whether the highlights are visible.
    struct GroupHere {
        std::vector<std::uint32_t> sources;
        int samples = 0;
    };
    void group_sources();
    [[nodiscard]] glm::dvec2 point_of(const Source& s, double choice, const glm::dvec2& place) const;
    void add_source(const HighlightMotion::Moment& m, const MergedHighlights::Merged& of,
                    const SheetMesh& mesh, KernelNumberCache& cache);
    [[nodiscard]] bool is_sharp(const Highlight& h) const;
    void make_sharp_kernels(KernelReach limits);
    struct Part {
        int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< image px
        std::array<float, SeenTile::pixels> share{};
    };
    [[nodiscard]] const Kernel& kernel_of(const Source& s) const {
        return s.is_sharp ? sharp_kernels_[s.kernel] : (*kernels_)[s.kernel];
    }
    [[nodiscard]] double response(const Source& s, int x, int y) const;
    [[nodiscard]] bool passes_near(const Source& s, int x, int y) const;
    [[nodiscard]] bool reach(int x, int y, int width, int height) const;
    [[nodiscard]] bool sees(const Source& s, std::uint32_t texel, float inverse_z) const;
    const TreeSheets& sheets_;
    Aperture aperture_;
    FocusGeometry geometry_;
    RasterWindow window_;
    bool round_;
    std::unique_ptr<ResponseModel> model_;
    std::unique_ptr<KernelTable> kernels_;
    std::vector<Kernel> sharp_kernels_;  ///< of almost sharp, static light sources, one for each
    std::vector<Source> sources_;        ///< sorted by group
    std::vector<SourcePart> parts_;
    std::vector<Group> groups_;
    /// A light source, merged from neighbouring highlights, and the image pixels that its blur may reach.
    struct Reach {
        RasterWindow pixels;
        std::uint32_t source = 0;
    };
    /// Calls `take` for the light sources whose blur may reach the tile (square of the image) that contains
    /// the pixel (x, y), until a call returns true. Returns whether one did. `take` receives a Reach, which
    /// states the pixels that the blur may reach. `take` must test these pixels: sources with a wide blur are
    /// listed for a whole row of tiles, so some of them may not reach this tile.
    template <typename Take>
    bool any_near(int x, int y, const Take& take) const {
        const int row = y / SeenTile::edge, column = x / SeenTile::edge;
        return std::ranges::any_of(wide_[static_cast<std::size_t>(row)], take) ||
               std::ranges::any_of(narrow_[static_cast<std::size_t>(row * tile_columns_ + column)], take);
    }
    static constexpr int passing_px = 1;  ///< distance within which a moving source counts as near
    /// A light source is listed for each tile (square of the image) that its blur may reach. But if the blur
    /// is wider than this many tiles, it is listed only once for each row of tiles, to save memory.
    static constexpr int widest_tiles = 4;
    int tile_columns_ = 0;
    std::vector<std::vector<Reach>> narrow_;  ///< per tile of the image
    std::vector<std::vector<Reach>> wide_;    ///< per row of tiles
};

}  // namespace postlens
