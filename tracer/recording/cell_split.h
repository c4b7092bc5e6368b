// Decides whether a quadtree cell is divided, from the records (shaded surface hits) at its corners.
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
    /// `samples` are the point samples at cell corners, and `chunks` hold their records.
    /// Keeps references to all arguments. `samples` and `chunks` may change between calls.
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
    /// Returns whether the visible surface at the cell's centre differs from those at its corners.
    /// The cell must then be divided. `centre` is the index of the central sample.
    [[nodiscard]] bool centre_differs(const CornerCell& c, std::uint32_t centre) const;
    /// A RecordMark to set on a record, which is given by its index in its chunk.
    struct Mark {
        std::uint32_t chunk = 0, record = 0;
        std::uint8_t mark = 0;
    };
    using Marks = std::vector<Mark>;
    /// Appends marks for the records at the corners of an undivided cell.
    /// - `fine_texture`: the texture has contrast between the corners, and `colour_levels` forbids division.
    /// - `gap`: several parts of one object may lie in the cell, and `edge_levels` forbids division.
    void mark_leaf(const CornerCell& c, Marks& marks) const;

  private:
    /// The shading tree of one visible or hidden surface of a sample. `rgb` is its radiance.
    /// Its nodes are the records [first, first + count) of `chunk`, sorted by path.
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
    /// True if the contrast between two radiances is high enough to divide a cell [mitchell1987].
    /// The formula's term 0.05 makes it insensitive to small differences between dark colours.
    [[nodiscard]] bool has_contrast(double lo, double hi) const;
    /// True if an edge lies between corners of similar colours: in the texture, or of a shadow.
    [[nodiscard]] bool pattern_between(const Seen* s, int count) const;
    void mark_textures(const std::array<Seen, 4>& s, Marks& marks) const;
    void mark_parts(const std::array<Seen, 4>& s, Marks& marks) const;
    /// True if the cell is wider than 2^-levels px, so a limit of `levels` levels allows its division.
    [[nodiscard]] bool is_larger(const CornerCell& c, int levels) const {
        return c.size > grid_.unit >> std::min(levels, settings_.levels);
    }
    /// Returns the n-th node of the first sample, and its counterparts in the others: the nodes
    /// with the same object and path (bounces). Empty if a sample has none.
    [[nodiscard]] static std::optional<NodeOfEach> nodes_like(const Seen* s, int count, std::uint32_t n);
    /// Returns the node with this path (sequence of bounces) in the shading tree of one surface.
    /// Tests the node `guess` first, because most corners of a cell have the same tree.
    [[nodiscard]] static std::optional<std::uint32_t> node_of_path(NodePath path, const Seen& in,
                                                                   std::uint32_t guess);
    /// Like node_of_path, but also requires the id of `wanted`.
    [[nodiscard]] static std::optional<std::uint32_t> node_like(const Record& wanted, const Seen& in,
                                                                std::uint32_t guess);
    [[nodiscard]] static bool shadows_differ(const Seen* s, const NodeOfEach& node, int count);
    /// True if the texture between the samples gives the node's radiance enough contrast to divide the cell.
    /// All texture colours in the bounding box of the samples' texture positions count.
    [[nodiscard]] bool texture_differs(const Seen* s, const NodeOfEach& node, int count) const;
    [[nodiscard]] Seen visible_layer(const CornerSample& s) const {
        return {s.id, s.part, {s.r, s.g, s.b}, &chunks_[s.chunk], s.first, s.visible};
    }
    /// Returns the layer (shading tree of one surface) that begins at record `at` of the sample.
    /// Sets `at` to the index after its last record.
    [[nodiscard]] Seen take_layer(const CornerSample& s, std::uint32_t& at) const;
    /// True if the cell may contain a narrow object that all its corners miss.
    /// If `hidden` is false, objects behind the farthest visible surface at the corners do not count.
    [[nodiscard]] bool small_things_ask(const CornerCell& c, bool hidden) const;
    /// True if all corners show the same part of an object, but another part's outline passes in front of it.
    [[nodiscard]] bool outline_between(const CornerCell& c) const;
    /// True if the cell may contain the image of a small bright object in a mirror or in glass.
    /// `s` holds the shading trees at its corners.
    [[nodiscard]] bool bright_images_ask(const CornerCell& c, const std::array<Seen, 4>& s) const;
    /// True if hidden surfaces at the corners differ so much that the cell must be divided.
    /// Only hidden surfaces after the same bounces are compared. Corners without one are ignored.
    [[nodiscard]] bool hidden_layers_differ(const CornerCell& c) const;
    /// Returns the path (sequence of bounces), as bits, of the record `at` of a sample, or `none` if there is
    /// none.
    [[nodiscard]] std::uint32_t next_path(std::uint32_t sample, std::uint32_t at, std::uint32_t none) const;

    const WhittedTracer& tracer_;
    const SmallThings& things_;
    const SubdivisionSettings& settings_;
    const CornerGrid& grid_;
    const std::vector<CornerSample>& samples_;
    const std::vector<TracedSamples>& chunks_;
};

}  // namespace postlens
