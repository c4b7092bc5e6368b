// Highlights over the views of a light field: each spread by its exact impulse response, as far as the lens
// sees it.
#pragma once

#include <memory>
#include <vector>

#include "focus/kernel.h"
#include "focus/lens_views.h"
#include "focus/moving_highlights.h"
#include "focus/response_model.h"
#include "focus/splat_tables.h"
#include "lens/aperture.h"
#include "reproject/patch_field.h"

namespace postlens {

/// What a mean of views would show as a ghost of the light for each: which light that is, for `tree_sheets`.
/// Nothing for apertures whose responses differ over the field or are not images of their outline.
[[nodiscard]] HighlightRule highlight_rule(const Aperture& aperture, const FocusGeometry& geometry);

/// The light that the rule has taken from the sheets. At a pixel the response's value comes through one point
/// of the lens. Whether that point sees the light: of what is seen directly, exactly, by drawing what stands
/// before it as the light sees the lens; of what mirrors and glass show, and of lights beyond the brightest
/// of a tile, by the views nearest to the point; of what moves, nearest to it and to the instant.
class FieldHighlights {
  public:
    /// Keeps references to `sheets`. `window`: the picture's pixels. `motion`: null: nothing moves.
    FieldHighlights(const TreeSheets& sheets, const Aperture& aperture, const FocusGeometry& geometry,
                    const RasterWindow& window, const HighlightMotion* motion = nullptr);

    [[nodiscard]] bool any() const { return !sources_.empty(); }
    /// What is added to these views. `set`: of the views; what is drawn is sampled elsewhere for each, as
    /// they are. `instants`: of the views, as shares of the light that has come in by then; may be empty
    /// where nothing moves. Keeps a reference to this.
    [[nodiscard]] std::unique_ptr<Lights> over(const std::vector<LensViewPoint>& views, int set,
                                               const std::vector<double>& instants = {}) const;

  private:
    class OverViews;
    struct Source {
        int x = 0, y = 0;  ///< picture px of the kernel's anchor
        std::uint32_t kernel = 0;
        glm::dvec2 at{0};  ///< picture px
        std::array<float, 3> rgb{};
        double square = 0;  ///< light times radiance, of the brightest channel
        glm::dmat2 lens_from_px{1};
        float inverse_z = 0;
        bool by_all = false;  ///< all views are asked, not those near one point of the lens
        double u = -1;        ///< of the light, what has come in by then: HighlightMotion; -1: always there
        SheetKey key;
        std::uint32_t sheet = 0;
        std::uint32_t group = 0;  ///< neighbours that one drawing serves
    };
    /// Sources close together, as one in their middle.
    struct Group {
        Source middle;
        int column = 0, row = 0;  ///< among the squares whose lights are seen alike
        double light = 0;
        glm::dvec2 spread_px{0};                             ///< deviation of its sources from the middle
        int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;  ///< picture px that their responses reach
    };
    /// One that reaches a tile: its sources there, and the samples a pixel that are drawn of what stands
    /// before it; 0: the views are asked.
    struct GroupHere {
        std::vector<std::uint32_t> sources;
        int samples = 0;
    };
    void group_sources();
    void add_source(const HighlightMotion::Moment& m, const SheetMesh& mesh, KernelNumberCache& cache);
    /// Of a part of a tile, the share of each pixel that gets the light.
    struct Part {
        int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< picture px
        std::array<float, SeenTile::pixels> share{};
    };
    [[nodiscard]] bool reaches(const Source& s, int x, int y, int width, int height) const;
    [[nodiscard]] bool reach(int x, int y, int width, int height) const;
    [[nodiscard]] bool sees(const Source& s, std::uint32_t texel, float inverse_z) const;
    const TreeSheets& sheets_;
    FocusGeometry geometry_;
    RasterWindow window_;
    bool round_;
    std::unique_ptr<ResponseModel> model_;
    std::unique_ptr<KernelTable> kernels_;
    std::vector<Source> sources_;  ///< those of a group together
    std::vector<Group> groups_;
    std::vector<std::vector<std::uint32_t>> rows_;  ///< sources by rows of 64 px that they reach
};

}  // namespace postlens
