// Highlights over the views of a light field: each spread by its exact impulse response, as far as the lens
// sees it.
#pragma once

#include <memory>
#include <vector>

#include "focus/kernel.h"
#include "focus/lens_views.h"
#include "focus/response_model.h"
#include "focus/splat_tables.h"
#include "lens/aperture.h"
#include "reproject/patch_field.h"

namespace postlens {

/// What a mean of views would show as a ghost of the light for each: which light that is, for `tree_sheets`.
/// Nothing for apertures whose responses differ over the field or are not images of their outline.
[[nodiscard]] HighlightRule highlight_rule(const Aperture& aperture, const FocusGeometry& geometry);

/// Adds the light that the rule has taken from the sheets. At a pixel the response's value comes through one
/// point of the lens. Whether that point sees the light: of what is seen directly, exactly, by drawing what
/// stands before it as the light sees the lens; of what mirrors and glass show, and of lights beyond the
/// brightest of a tile, by the views nearest to the point.
class FieldHighlights final : public Lights {
  public:
    /// Keeps references to `sheets`. `set`: of the views; what is drawn is sampled elsewhere for each, as
    /// they are. `window`: the picture's pixels.
    FieldHighlights(const TreeSheets& sheets, const Aperture& aperture, const FocusGeometry& geometry,
                    const std::vector<LensViewPoint>& views, int set, const RasterWindow& window);

    [[nodiscard]] bool any() const { return !sources_.empty(); }
    [[nodiscard]] bool reach(int x, int y, int width, int height) const override;
    void add(const TileViews& views, std::vector<double>& rgb) const override;

  private:
    struct Source {
        int x = 0, y = 0;  ///< picture px of the kernel's anchor
        std::uint32_t kernel = 0;
        glm::dvec2 at{0};  ///< picture px
        std::array<float, 3> rgb{};
        glm::dmat2 lens_from_px{1};
        float inverse_z = 0;
        bool by_all = false;  ///< all views are asked, not those near one point of the lens
        SheetKey key;
        std::uint32_t sheet = 0;
        std::uint32_t group = 0;  ///< neighbours that one drawing serves
    };
    /// Sources close together, as one in their middle.
    struct Group {
        Source middle;
        int column = 0, row = 0;  ///< among the squares whose lights are seen alike
        double light = 0;
        int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;  ///< picture px that their responses reach
    };
    /// One that reaches a tile: its sources there, and the samples a pixel that are drawn of what stands
    /// before it; 0: the views are asked.
    struct GroupHere {
        std::vector<std::uint32_t> sources;
        int samples = 0;
    };
    void group_sources();
    void add_source(const Highlight& h, const SheetMesh& mesh, KernelNumberCache& cache);
    void lay_nearest_views(const std::vector<LensViewPoint>& views);
    /// Of a part of a tile, the share of each pixel that gets the light.
    struct Part {
        int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< picture px
        std::array<float, SeenTile::pixels> share{};
    };
    void draw_shares(const Group& g, const PatchMesh& patches, int samples, Part& part) const;
    /// Those that reach the tile.
    [[nodiscard]] std::vector<GroupHere> groups_in(const TileViews& views) const;
    void add(const Source& s, const Part* part, const TileViews& views, std::vector<double>& rgb) const;
    [[nodiscard]] bool reaches(const Source& s, int x, int y, int width, int height) const;
    /// Of the views nearest to the point of the lens that `at`, picture px, gets its light through.
    [[nodiscard]] double seen_share(const Source& s, const TileViews& views, std::size_t pixel,
                                    const glm::dvec2& at) const;
    [[nodiscard]] bool sees(const Source& s, std::uint32_t texel, float inverse_z) const;
    /// In a view, at a pixel of its tile.
    [[nodiscard]] bool sees(const Source& s, const TileViews& views, std::size_t view,
                            std::size_t pixel) const {
        const std::size_t k = view * TileViews::view + pixel;
        return sees(s, views.texel[k], views.inverse_z[k]);
    }

    static constexpr int table_edge = 64;       ///< cells across the lens
    static constexpr int nearest = 3;           ///< views that are asked
    static constexpr double table_reach = 1.1;  ///< lens radii
    const TreeSheets& sheets_;
    FocusGeometry geometry_;
    RasterWindow window_;
    bool round_;
    std::size_t view_count_ = 0;
    int set_;
    std::unique_ptr<ResponseModel> model_;
    std::unique_ptr<KernelTable> kernels_;
    std::vector<Source> sources_;  ///< those of a group together
    std::vector<Group> groups_;
    std::vector<std::array<std::uint32_t, nearest>> nearest_;
    std::vector<std::vector<std::uint32_t>> rows_;  ///< sources by rows of 64 px that they reach
};

}  // namespace postlens
