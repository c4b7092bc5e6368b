// Reads rows of a sample file. Finds the quadtree leaves and the surfaces of each pixel from the records.
#pragma once

#include <functional>
#include <vector>

#include "motionblur/groups/moving_group.h"
#include "reproject/sheets/sample_surfaces.h"

namespace postlens {

/// Quadtree leaves and surfaces of the pixels in rows [y_begin, y_end).
struct BandSurfaces {
    int x_begin = 0, width = 0, y_begin = 0, y_end = 0;  ///< width: columns of the band, one more than pixels
    PixelLeaves leaves;
    SampleSurfaces surfaces;

    /// Calls on_leaf(leaf) for each quadtree leaf of a pixel.
    template <typename OnLeaf>
    void for_each_leaf(int x, int y, const OnLeaf& on_leaf) const {
        const std::size_t k = static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x - x_begin);
        for (std::uint32_t i = leaves.leaf_offsets[k]; i < leaves.leaf_offsets[k + 1]; ++i)
            on_leaf(leaves.leaves[i]);
    }
};

inline constexpr int band_rows = 32;

/// Records of one instant in bands of `band_rows` rows of pixels. Each band also contains the row below, with
/// the records on its lower border. Only the bands that are needed are in memory. These are few, because
/// moving objects usually cover few rows of a frame.
class RecordBands {
  public:
    /// Keeps a reference to the file. Does not read any records.
    explicit RecordBands(const SampleFileReader& file, std::size_t instant = 0);

    /// Reads all bands one after another. Keeps those in memory for which `keep` returns true.
    void read_all(const std::function<bool(const RecordBand&)>& keep);
    /// Reads the bands of pixel rows [y_begin, y_end) that are not in memory.
    void need(int y_begin, int y_end);
    void need_all() { need(file_.y_begin(), file_.y_end()); }
    /// All bands of the recorded rows. A band that is not in memory has its range of rows and columns, but
    /// neither records nor offsets.
    [[nodiscard]] const std::vector<RecordBand>& bands() const { return bands_; }

  private:
    const SampleFileReader& file_;
    std::size_t instant_;
    std::vector<RecordBand> bands_;

    void read(RecordBand& band) const;
};

/// Finds the surfaces of the bands that contain rows [y_begin, y_end). These bands must be in memory. The
/// result has one element per band. Elements of all other bands are empty.
[[nodiscard]] std::vector<BandSurfaces> band_surfaces(const std::vector<RecordBand>& bands, int y_begin,
                                                      int y_end);

/// Finds the group to which an object id belongs. The objects of a group share a path.
class GroupTable {
  public:
    explicit GroupTable(const std::vector<MovingGroup>& groups);
    /// Index of the id's group, or -1 if it belongs to none.
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
