// Decides whether a quadtree cell is divided, based on the records (shaded surface hits) at its corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "tracer/recording/corner_grid.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/recording/small_things.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// The criteria by which sample_corners divides cells.
class CellSplit {
  public:
    /// `samples` are the point samples at cell corners, and `chunks` hold the records of these samples. Keeps
    /// references to all arguments. The contents of `samples` and `chunks` may change between calls.
    CellSplit(const WhittedTracer& tracer, const SmallThings& things, const SubdivisionSettings& settings,
              const CornerGrid& grid, const std::vector<CornerSample>& samples,
              const std::vector<TracedSamples>& chunks)
        : tracer_(tracer),
          things_(things),
          settings_(settings),
          grid_(grid),
          samples_(samples),
          chunks_(chunks) {}

    [[nodiscard]] bool splits(const CornerCell& c) const;
    /// Returns whether the sample at the centre of the cell differs from those at its corners. If so, the
    /// cell must be divided. `centre` is the index of the central sample. Compares only visible surfaces.
    [[nodiscard]] bool centre_differs(const CornerCell& c, std::uint32_t centre) const;
    /// The RecordMark to set on a record. `record` is the index of the record in its chunk.
    struct Mark {
        std::uint32_t chunk = 0, record = 0;
        std::uint8_t mark = 0;
    };
    using Marks = std::vector<Mark>;
    /// Appends marks for the records at the corners of an undivided cell. `fine_texture`: the texture has
    /// contrast between the corners. `gap`: the corners show several parts of one object, or the outline of
    /// another part crosses the cell. A cell is marked only if `colour_levels` (`fine_texture`) or
    /// `edge_levels` (`gap`) forbids further division.
    void mark_leaf(const CornerCell& c, Marks& marks) const;

  private:
    /// The shading tree of one visible or hidden surface of a sample. `id` and `part` are those of the
    /// surface, and `rgb` is the radiance of the whole tree. The nodes are the records [first, first + count)
    /// of `chunk`, sorted by path.
    struct Seen {
        std::uint32_t id = 0, part = 0;
        std::array<float, 3> rgb{};
        const TracedSamples* chunk = nullptr;
        std::uint32_t first = 0, count = 0;
    };
    static constexpr int most_samples = 5;  ///< compared per cell, at its corners and its centre
    /// A node of each sample, as an index into its chunk.
    using NodeOfEach = std::array<std::uint32_t, most_samples>;
    [[nodiscard]] bool differ(const CornerCell& c, const Seen* s, int count) const;
    /// True if the contrast between two radiances is high enough to divide a cell [mitchell1987]. The term
    /// 0.05 in the contrast formula keeps small differences between dark colours from dividing it.
    [[nodiscard]] bool has_contrast(double lo, double hi) const;
    /// True if a cell contains an edge although its corners have similar colours: the texture has contrast
    /// between the corners, or different lights are shadowed at them.
    [[nodiscard]] bool pattern_between(const Seen* s, int count) const;
    void mark_textures(const std::array<Seen, 4>& s, Marks& marks) const;
    void mark_parts(const std::array<Seen, 4>& s, Marks& marks) const;
    /// True if a limit of `levels` levels still allows the cell to be divided: it is wider than 2^-levels px.
    [[nodiscard]] bool is_larger(const CornerCell& c, int levels) const {
        return c.size > grid_.unit >> std::min(levels, settings_.levels);
    }
    /// Returns the n-th node of the first sample and, for every other sample, the node on the same object
    /// after the same bounces. Empty if a sample has no such node.
    [[nodiscard]] static std::optional<NodeOfEach> nodes_like(const Seen* s, int count, std::uint32_t n);
    /// Returns the node with the given path (sequence of bounces) in a layer, the shading tree of one
    /// surface. The node with index `guess` is tested first, because most corners of a cell have the same
    /// shading tree.
    [[nodiscard]] static std::optional<std::uint32_t> node_of_path(NodePath path, const Seen& in,
                                                                   std::uint32_t guess);
    /// Like node_of_path, but also requires the id of `wanted`.
    [[nodiscard]] static std::optional<std::uint32_t> node_like(const Record& wanted, const Seen& in,
                                                                std::uint32_t guess);
    [[nodiscard]] static bool shadows_differ(const Seen* s, const NodeOfEach& node, int count);
    /// True if the texture changes so much between the samples that the radiance of the node has contrast.
    /// All texture colours in the bounding box of the samples' texture positions count.
    [[nodiscard]] bool texture_differs(const Seen* s, const NodeOfEach& node, int count) const;
    [[nodiscard]] Seen visible_layer(const CornerSample& s) const {
        return {s.id, s.part, {s.r, s.g, s.b}, &chunks_[s.chunk], s.first, s.visible};
    }
    /// Returns the layer (shading tree of one visible or hidden surface) that begins at record `at` of the
    /// sample. Sets `at` to the index after the last record of the layer.
    [[nodiscard]] Seen take_layer(const CornerSample& s, std::uint32_t& at) const;
    /// True if the cell may contain a narrow object that all its corners miss. Objects behind the farthest
    /// visible surface at the corners count only if hidden surfaces are recorded at a corner.
    [[nodiscard]] bool small_things_ask(const CornerCell& c, bool hidden) const;
    /// True if all corners of the cell show the same part of an object, but the outline of another part
    /// passes in front of it.
    [[nodiscard]] bool outline_between(const CornerCell& c) const;
    /// True if the cell may contain the image of a small bright object in a mirror or in glass. `s` holds the
    /// shading trees of the surfaces that are visible at its corners.
    [[nodiscard]] bool bright_images_ask(const CornerCell& c, const std::array<Seen, 4>& s) const;
    /// True if the hidden surfaces at the corners differ so much that the cell must be divided, by the same
    /// criteria as for visible surfaces. Only hidden surfaces after the same sequence of bounces are
    /// compared. Corners without such a surface are ignored.
    [[nodiscard]] bool hidden_layers_differ(const CornerCell& c) const;
    /// Returns the path (sequence of bounces), as bits, of the first node of a layer (shading tree of one
    /// surface). The layer begins at record `at` of the sample. Returns `none` if there is no such record.
    [[nodiscard]] std::uint32_t next_path(std::uint32_t sample, std::uint32_t at, std::uint32_t none) const;

    const WhittedTracer& tracer_;
    const SmallThings& things_;
    const SubdivisionSettings& settings_;
    const CornerGrid& grid_;
    const std::vector<CornerSample>& samples_;
    const std::vector<TracedSamples>& chunks_;
};

}  // namespace postlens
