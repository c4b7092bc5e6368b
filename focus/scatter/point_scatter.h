// Blurs samples (points of the recorded scene) one by one, and adds them to the image. Most blur kernels are
// uniform inside, and only the changes at their outline are processed. So the time per sample is proportional
// to the length of this outline.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "focus/scatter/splat_tables.h"

namespace postlens {

/// Adds blurred samples to a few rows of pixels. Each pixel has four sums over the samples. Channels 0 to 2
/// are colour times the value of the blur kernel. Channel 3 is weight times this value.
///
/// A wide kernel has the same value in most pixels of a row, its interior. So only two changes are stored: at
/// the first pixel of the interior, this value is added, and behind the last, it is subtracted. Later, all
/// changes are summed along the row. These sums use double, because float sums would leave a rounding error
/// to the right of every bright sample.
class PointScatter {
  public:
    /// `channel` is a colour channel, 0 to 2. If each colour channel has its own blur kernels, those of this
    /// channel are used. If all channels share their kernels, leave it at 0.
    explicit PointScatter(const SplatTables& tables, std::size_t channel = 0)
        : tables_(tables), channel_(channel) {}

    /// Adds the light of all samples whose blur reaches the rows `rows` of the blurred image.
    void run(const RasterWindow& rows);

    /// The pixels that the blur of any sample may reach. Sums of light are stored only for these pixels.
    [[nodiscard]] const RasterWindow& reached() const { return reached_; }
    [[nodiscard]] bool reaches(int y) const { return y >= reached_.y_begin && y < reached_.y_end; }
    /// Returns the four sums of the pixel (x, y): red, green, blue and weight. In memory, they are followed
    /// by the sums of the next pixels of the row.
    [[nodiscard]] const double* sums(int x, int y) const { return sum_.data() + index(x, y); }

  private:
    struct Pass {
        std::span<const Splat> splats;
        int y;
    };
    void find_passes(std::size_t reach_class);
    [[nodiscard]] std::size_t index(int x, int y) const {
        return 4 * (static_cast<std::size_t>(y - rows_.y_begin) * stride_ +
                    static_cast<std::size_t>(x - rows_.x_begin));
    }

    const SplatTables& tables_;
    std::size_t channel_;
    RasterWindow rows_, reached_;
    std::vector<Pass> passes_;
    std::size_t stride_ = 0;      ///< pixels per row of the buffers, one more than in rows_
    std::vector<double> sum_;     ///< sums of rows_; undefined outside reached_
    std::vector<double> change_;  ///< differences to the pixel on the left
};

}  // namespace postlens
