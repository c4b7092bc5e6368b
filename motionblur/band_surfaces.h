// Rows of a sample file as leaves and surfaces, for all that walks over pixels.
#pragma once

#include <functional>
#include <vector>

#include "motionblur/moving_group.h"
#include "reproject/sample_surfaces.h"

namespace postlens {

/// The pixels of rows [y_begin, y_end).
struct BandSurfaces {
    int x_begin = 0, width = 0, y_begin = 0, y_end = 0;  ///< width: of the band, one more than it has pixels
    PixelLeaves leaves;
    SampleSurfaces surfaces;

    /// leaf(leaf) for those of a pixel.
    template <typename OnLeaf>
    void for_each_leaf(int x, int y, const OnLeaf& on_leaf) const {
        const std::size_t k = static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x - x_begin);
        for (std::uint32_t i = leaves.leaf_offsets[k]; i < leaves.leaf_offsets[k + 1]; ++i)
            on_leaf(leaves.leaves[i]);
    }
};

inline constexpr int band_rows = 32;

/// The records of an instant, in bands of `band_rows` rows of pixels and the closing row, as far as they are
/// in memory: a frame has many more rows than those over which something moves.
class RecordBands {
  public:
    /// Keeps a reference to the file and reads nothing yet.
    explicit RecordBands(const SampleFileReader& file, std::size_t instant = 0);

    /// Reads all, one band after the other; keeps those for which `keep` says so.
    void read_all(const std::function<bool(const RecordBand&)>& keep);
    /// Reads those in which pixel rows [y_begin, y_end) lie, unless they are there.
    void need(int y_begin, int y_end);
    void need_all() { need(file_.y_begin(), file_.y_end()); }
    /// A band that is not in memory has rows and columns, and no records and offsets.
    [[nodiscard]] const std::vector<RecordBand>& bands() const { return bands_; }

  private:
    const SampleFileReader& file_;
    std::size_t instant_;
    std::vector<RecordBand> bands_;

    void read(RecordBand& band) const;
};

/// Of the bands in which rows [y_begin, y_end) lie, which must be in memory; the others stay empty.
[[nodiscard]] std::vector<BandSurfaces> band_surfaces(const std::vector<RecordBand>& bands, int y_begin,
                                                      int y_end);

/// Which group an id belongs to.
class GroupTable {
  public:
    explicit GroupTable(const std::vector<MovingGroup>& groups);
    /// -1: to none.
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
