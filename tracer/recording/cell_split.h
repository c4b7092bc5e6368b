// Decides whether a quadtree cell is divided, from the surfaces recorded at its corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/recording/corner_grid.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/recording/small_things.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// The criteria by which sample_corners divides cells.
class CellSplit {
  public:
    /// Keeps references to all arguments. The contents of `samples` and `chunks` may change between calls.
    CellSplit(const WhittedTracer& tracer, const SmallThings& things, const SubdivisionSettings& settings,
              const CornerGrid& grid, const std::vector<CornerSample>& samples,
              std::vector<TracedSamples>& chunks)
        : tracer_(tracer),
          things_(things),
          settings_(settings),
          grid_(grid),
          samples_(samples),
          chunks_(chunks) {}

    [[nodiscard]] bool splits(const CornerCell& c) const;
    /// Returns true if the eye ray through the cell's centre sees something else than the eye rays through
    /// the cell's corners. `centre` is the index of the sample at the centre.
    [[nodiscard]] bool centre_differs(const CornerCell& c, std::uint32_t centre) const;
    /// Sets flags in the records (surface hits) at the corners of an undivided quadtree cell if the image may
    /// have details between the corners:
    /// - `fine_texture`: the texture has contrast there, but the limit `colour_levels` forbids further
    ///   division.
    /// - `gap`: the cell shows several parts of one object or the outline of another part, but the limit
    ///   `edge_levels` forbids further division.
    ///
    /// Thread-safe.
    void mark_leaf(const CornerCell& c) const;

  private:
    /// One shading tree of a sample: a surface that the sample's eye ray hits, either visible or hidden
    /// behind others, and all surfaces that are seen in it by reflection or refraction. `first` is the index
    /// of the tree's first record in `chunk`, and `count` is its number of records.
    struct Seen {
        std::uint32_t id = 0, part = 0;
        NodePath path;
        std::array<float, 3> rgb{};
        TracedSamples* chunk = nullptr;
        std::uint32_t first = 0, count = 0;
    };
    static constexpr int most_samples = 5;  ///< compared per cell, at its corners and its centre
    /// A node of each sample, as an index into its chunk.
    using NodeOfEach = std::array<std::uint32_t, most_samples>;
    [[nodiscard]] bool differ(const CornerCell& c, const Seen* s, int count) const;
    /// Returns true if the contrast between two radiances is high enough to divide a cell [mitchell1987].
    /// The contrast is (hi - lo) / (hi + lo + 0.05). The constant 0.05 makes it insensitive to small
    /// differences between dark colours.
    [[nodiscard]] bool has_contrast(double lo, double hi) const;
    /// Returns true if the edge of a texture or of a shadow lies between the samples `s` at the corners of a
    /// quadtree cell. This can be so although the samples have similar colours, for example if a texture has
    /// thin stripes.
    [[nodiscard]] bool pattern_between(const Seen* s, int count) const;
    void mark_textures(const std::array<Seen, 4>& s) const;
    static void mark_parts(const std::array<Seen, 4>& s);
    /// Returns true if the quadtree cell `c` is wider than 2^-levels px. Then a limit of `levels` divisions
    /// of a pixel allows dividing the cell further.
    [[nodiscard]] bool is_larger(const CornerCell& c, int levels) const {
        return c.size > grid_.unit >> std::min(levels, settings_.levels);
    }
    /// `s` holds `count` shading trees of different samples. Takes the surface point number n of the first
    /// tree and finds its counterpart in every other tree: the point of the same object after the same
    /// bounces. Returns false if a tree has no counterpart.
    [[nodiscard]] static bool nodes_like(const Seen* s, int count, std::uint32_t n, NodeOfEach& out);
    /// Returns the index of the surface point in the shading tree `in` that is reached by the sequence of
    /// bounces `path`. Tests the index `guess` first. It is the index of this point in another tree, and the
    /// trees at a cell's corners are mostly alike.
    [[nodiscard]] static std::optional<std::uint32_t> node_of_path(NodePath path, const Seen& in,
                                                                   std::uint32_t guess);
    /// Like node_of_path, but also requires the id of `wanted`.
    [[nodiscard]] static std::optional<std::uint32_t> node_like(const Record& wanted, const Seen& in,
                                                                std::uint32_t guess);
    [[nodiscard]] static bool shadows_differ(const Seen* s, const NodeOfEach& node, int count);
    /// Returns true if the colour of a texture varies so much between the samples at the corners of a
    /// quadtree cell that the cell must be divided. All colours in the part of the texture between the
    /// samples are considered, i.e. in the bounding box of their texture coordinates.
    [[nodiscard]] bool texture_differs(const Seen* s, const NodeOfEach& node, int count) const;
    [[nodiscard]] Seen visible_layer(std::uint32_t sample) const {
        const CornerSample& s = samples_[sample];
        return {s.id, s.part, {}, {s.r, s.g, s.b}, &chunks_[s.chunk], s.first, s.visible};
    }
    [[nodiscard]] std::array<Seen, 4> visible_layers(const CornerCell& c) const {
        return {visible_layer(c.corner[0]), visible_layer(c.corner[1]), visible_layer(c.corner[2]),
                visible_layer(c.corner[3])};
    }
    /// The records of a sample form several shading trees, one for each visible or hidden surface on the eye
    /// ray. Sets `out` to the tree whose first record has the index `at`. Then advances `at` past the tree's
    /// last record.
    void take_layer(const CornerSample& s, std::uint32_t& at, Seen& out) const;
    /// Returns true if the quadtree cell `c` must be divided, because it may contain a narrow object that the
    /// eye rays at all corners of the cell miss. If `hidden` is false, objects behind all surfaces that are
    /// visible at the cell's corners are ignored.
    [[nodiscard]] bool small_things_ask(const CornerCell& c, bool hidden) const;
    /// Returns true if all corners of the quadtree cell `c` show the same part of an object, but the outline
    /// of a nearer part crosses the cell between them. The nearer part may belong to the same object, such as
    /// another leaf of the same tree.
    [[nodiscard]] bool outline_between(const CornerCell& c) const;
    /// Returns true if the cell must be divided, because it may contain the image of a small bright object in
    /// a mirror or in glass. `s` holds the visible surfaces at the cell's four corners, each with the
    /// surfaces that are seen in it by reflection or refraction.
    [[nodiscard]] bool bright_images_ask(const CornerCell& c, const std::array<Seen, 4>& s) const;
    [[nodiscard]] bool hidden_layers_differ(const CornerCell& c) const;
    [[nodiscard]] std::uint32_t next_path(std::uint32_t sample, std::uint32_t at, std::uint32_t none) const;

    const WhittedTracer& tracer_;
    const SmallThings& things_;
    const SubdivisionSettings& settings_;
    const CornerGrid& grid_;
    const std::vector<CornerSample>& samples_;
    std::vector<TracedSamples>& chunks_;
};

}  // namespace postlens
