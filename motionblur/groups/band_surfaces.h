// Reads pixel rows of a sample file, and finds the recorded surfaces in each pixel. A quadtree divides the
// pixel into leaves, with samples at their corners.
#pragma once

#include <functional>
#include <vector>

#include "motionblur/groups/moving_group.h"
#include "reproject/sheets/sample_surfaces.h"

namespace postlens {

/// Quadtree leaves and surfaces of the pixels in rows [y_begin, y_end).
struct BandSurfaces {
    /// `width` is the number of samples in a row. It is the number of pixels plus one, because samples lie at
    /// the corners of pixels.
    int x_begin = 0, width = 0, y_begin = 0, y_end = 0;
    PixelLeaves leaves;
    SampleSurfaces surfaces;

    /// Calls on_leaf(leaf) for each undivided quadtree cell of pixel (x, y).
    template <typename OnLeaf>
    void for_each_leaf(int x, int y, const OnLeaf& on_leaf) const {
        const std::size_t k = static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x - x_begin);
        for (std::uint32_t i = leaves.leaf_offsets[k]; i < leaves.leaf_offsets[k + 1]; ++i)
            on_leaf(leaves.leaves[i]);
    }
};

inline constexpr int band_rows = 32;

/// Reads the samples of one instant in bands of `band_rows` rows, and keeps only the needed bands in memory.
///
/// Neighbouring bands share one row of samples.
class RecordBands {
  public:
    /// Keeps a reference to the file. Does not read any records.
    explicit RecordBands(const SampleFileReader& file, std::size_t instant = 0);

    /// Reads the records of all pixel rows, band by band. Keeps in memory only those bands for which `keep`
    /// returns true.
    void read_all(const std::function<bool(const RecordBand&)>& keep);
    /// Reads records from the file, so that all bands that overlap the pixel rows [y_begin, y_end) are in
    /// memory.
    void need(int y_begin, int y_end);
    void need_all() { need(file_.y_begin(), file_.y_end()); }
    /// Returns the bands (blocks of pixel rows) of the image, from top to bottom. All bands are returned, but
    /// a band contains records only if these were read and kept in memory.
    [[nodiscard]] const std::vector<RecordBand>& bands() const { return bands_; }

  private:
    const SampleFileReader& file_;
    std::size_t instant_;
    std::vector<RecordBand> bands_;

    void read(RecordBand& band) const;
};

/// Converts the records in each band (block of pixel rows) to a quadtree and surfaces. Returns one element
/// per band. It is empty if the band does not overlap the pixel rows [y_begin, y_end).
[[nodiscard]] std::vector<BandSurfaces> band_surfaces(const std::vector<RecordBand>& bands, int y_begin,
                                                      int y_end);

/// Maps the id of a moving object to the group to which it belongs. The objects of a group move along the
/// same path in the image.
class GroupTable {
  public:
    explicit GroupTable(const std::vector<MovingGroup>& groups);
    /// Returns the index of the group to which an object's id belongs, or -1 if it belongs to none.
    [[nodiscard]] int operator()(std::uint32_t id) const {
        if (id < small_.size()) return small_[id];
        const auto found =
            std::lower_bound(large_.begin(), large_.end(), std::pair<std::uint32_t, int>(id, -1));
        return found != large_.end() && found->first == id ? found->second : -1;
    }

  private:
    std::vector<int> small_;
    std::vector<std::pair<std::uint32_t, int>> large_;
};

}  // namespace postlens
