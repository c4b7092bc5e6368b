// Decides which pixels are divided into quarters, and which of these quadtree cells are divided further. A
// cell is divided if the eye rays through its corners see different surfaces or colours, or if a small object
// may lie between them.
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
    /// Keeps references to all arguments, in order to decide later which quadtree cells are divided. Between
    /// the calls of splits(), the caller may trace further samples and add them to `samples` and `chunks`.
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
    /// Returns true if the eye ray through the centre of the quadtree cell `c` sees a different surface or
    /// colour than those through its corners. `centre` is the index of the sample that the ray through the
    /// centre gave.
    [[nodiscard]] bool centre_differs(const CornerCell& c, std::uint32_t centre) const;
    /// Handles a quadtree cell that is not divided further. If the image may nevertheless have details
    /// between its corners, flags are set in the records (surface hits) at the corners:
    /// - `fine_texture`: the texture has contrast there, but the limit `colour_levels` forbids further
    ///   division.
    /// - `gap`: either the corners show different parts of one object, such as leaves of a tree, or the
    ///   outline of a part lies between them. But the limit `edge_levels` forbids further division.
    ///
    /// Thread-safe.
    void mark_leaf(const CornerCell& c) const;

  private:
    /// One surface that a sample's eye ray hits, visible or hidden behind others, with all surfaces that are
    /// seen in it by reflection or refraction. This group is called a shading tree. Its records are
    /// consecutive elements of the buffer `chunk`: `count` records from the index `first` on. `id`, `part`,
    /// `path` and `rgb` describe the first record.
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
    /// Finds the same object in several samples, to compare it between them. Each of the `count` elements of
    /// `s` describes one sample: an eye ray with all its reflections and refractions. The object is given by
    /// surface hit number n of the first sample. `out` gets the index of a hit of this object after the same
    /// bounces in every sample. Returns false if one is missing.
    [[nodiscard]] static bool nodes_like(const Seen* s, int count, std::uint32_t n, NodeOfEach& out);
    /// Returns the index of a surface hit in `in`, which describes one sample, i.e. an eye ray with all its
    /// reflections and refractions. The hit is given by `path`, the sequence of bounces before it. The index
    /// `guess` is tested first. It is the index at which another sample has its hit with this path, and
    /// neighbouring samples mostly have the same paths in the same order.
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
    /// Reads the records of a sample step by step. They are grouped: one group for each visible or hidden
    /// surface on the eye ray, with all surfaces that are seen in it by reflection or refraction. Sets `out`
    /// to the group that begins with record number `at`, and advances `at` to the next group.
    void take_layer(const CornerSample& s, std::uint32_t& at, Seen& out) const;
    /// Returns true if the quadtree cell `c` must be divided because of a narrow object, which all eye rays
    /// through the cell's corners may miss. If `hidden` is true, any narrow object in the cell counts. If it
    /// is false, an object counts only if it is nearer than the farthest surface that is visible at the
    /// corners, because otherwise it is hidden.
    [[nodiscard]] bool small_things_ask(const CornerCell& c, bool hidden) const;
    /// Returns true if the outline of a nearer part of an object crosses the quadtree cell `c`, although all
    /// corners of the cell show the same part behind it. The nearer part may belong to the same object, such
    /// as another leaf of the same tree.
    [[nodiscard]] bool outline_between(const CornerCell& c) const;
    /// Returns true if the quadtree cell `c` must be divided because of a mirror or glass, which may show a
    /// small bright object inside the cell. `s` describes the samples at the cell's four corners: the visible
    /// surface, with the surfaces that are seen in it by reflection or refraction.
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
