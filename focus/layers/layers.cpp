#include "focus/layers/layers.h"

#include <algorithm>
#include <tbb/enumerable_thread_specific.h>
#include <vector>

#include "core/progress.h"
#include "core/threads.h"
#include "focus/layers/layer_resolve.h"
#include "focus/layers/layer_sums.h"
#include "focus/layers/visibility.h"

namespace postlens {
namespace {

/// Width, in px, of the blocks into which the image is divided; each block is computed by one thread. With
/// this width, the sums for a block, of up to 192 B per pixel, fit into the L2 cache.
constexpr int block_width = 64;
constexpr int block_height = layers_block_px;
/// Largest number of fragments in memory at a time. A fragment is the blurred light of one surface at one
/// pixel, and takes about 200 B. Blocks of the image with more fragments are computed in groups of rows.
constexpr std::size_t most_sums = std::size_t{1} << 17;

/// Composites the surfaces in `fragments`, which reach the pixel (x, y), from near to far. Stores the
/// resulting colour in `out`. If the lens blurs red, green and blue differently, this function is called once
/// per colour channel, and stores only the channel `channel`.
void store(const LayerSplats& splats, std::span<Fragment> fragments, int x, int y, std::size_t channel,
           float* out) {
    const bool all = splats.kernels().channels() == 1;
    if (splats.parts().empty()) return;
    // `open` is the fraction of the lens that vignetting leaves open for the pixel (x, y). It reduces the
    // weights (covered fractions of the pixel) of all surfaces, so that even a fully covered pixel would seem
    // translucent. Therefore, the weights are divided by `open`.
    const double open = splats.responses().open_share(splats.picture(), x, y);
    if (open > 0 && open != 1) {
        for (Fragment& f : fragments) {
            f.covered /= open;
            for (SurfaceLight* light : {&f.seen, &f.hidden}) light->divide(open);
        }
    }
    const std::array<double, 3> rgb = composite(fragments, splats.geometry());
    for (std::size_t c = 0; c < 3; ++c) {
        if (!all && c != channel) continue;
        // A blurred colour is a mean of the colours of the samples, so it must lie within their range.
        // Rounding errors and the approximation of occlusion by functions that are linear over the lens could
        // cause values outside this range. Therefore, each colour channel is clamped to it.
        out[c] = static_cast<float>(open) *
                 std::clamp(static_cast<float>(rgb[c]), splats.colours().least[c], splats.colours().most[c]);
    }
}

/// Returns whether to compute through which side of the lens the light of `part` (a surface or mirror image)
/// arrives. This is needed only for directly visible surfaces, whose `path` of reflections and refractions is
/// empty (0). A mirror image uses the result of its mirror.
bool wants_lens(const LayerPart& part) {
    return part.path == 0;
}

/// A block of the image, with the groups of samples whose blur reaches it. `cells` contains the indices of
/// these groups (LayerCell), in ascending order.
struct Block {
    RasterWindow window;
    std::vector<std::uint32_t> cells;
};

std::vector<Block> blocks_of(const LayerSplats& splats) {
    const RasterWindow& picture = splats.picture();
    const int columns = (picture.width() + block_width - 1) / block_width;
    std::vector<Block> out;
    for (int y = picture.y_begin; y < picture.y_end; y += block_height) {
        for (int x = picture.x_begin; x < picture.x_end; x += block_width)
            out.push_back({common({x, x + block_width, y, y + block_height}, picture), {}});
    }
    for (std::size_t i = 0; i < splats.cells().size(); ++i) {
        const RasterWindow reach = common(splats.cells()[i].reach, picture);
        if (reach.width() <= 0 || reach.height() <= 0) continue;
        for (int row = (reach.y_begin - picture.y_begin) / block_height;
             row <= (reach.y_end - 1 - picture.y_begin) / block_height; ++row) {
            for (int column = (reach.x_begin - picture.x_begin) / block_width;
                 column <= (reach.x_end - 1 - picture.x_begin) / block_width; ++column) {
                out[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)]
                    .cells.push_back(static_cast<std::uint32_t>(i));
            }
        }
    }
    return out;
}

struct PartCells {
    const LayerPart* part;
    std::size_t begin, end;
    RasterWindow reach;  ///< within the block
};

void find_parts(const LayerSplats& splats, const Block& block, std::vector<PartCells>& parts) {
    parts.clear();
    for (std::size_t i = 0; i < block.cells.size(); ++i) {
        const LayerCell& cell = splats.cells()[block.cells[i]];
        const LayerPart* part = &splats.parts()[cell.part];
        const RasterWindow reach = common(cell.reach, block.window);
        if (parts.empty() || parts.back().part != part) {
            parts.push_back({part, i, i + 1, reach});
        } else {
            parts.back().end = i + 1;
            parts.back().reach = around(parts.back().reach, reach);
        }
    }
}

/// Blurs and composites the surfaces in blocks of the image, one block after another. Each thread has its own
/// object of this class, which reuses its buffers for all blocks.
class BlockLayers {
  public:
    explicit BlockLayers(const LayerSplats& splats) : splats_(splats) {}

    void run(const Block& of, Image& image);

  private:
    struct Entry {
        Fragment fragment;
        std::int32_t next;
    };

    void add_surface(std::span<const PartCells> parts, std::span<const std::uint32_t> cells,
                     std::size_t channel, bool with_lens);
    void push(int x, int y, const Fragment& fragment);
    void store_pixels(std::size_t channel, Image& image);
    [[nodiscard]] bool meets_another(std::size_t surface) const;

    const LayerSplats& splats_;
    RasterWindow rows_;  ///< the rows of the block that are computed at present
    std::vector<PartCells> parts_;
    std::vector<RasterWindow> surfaces_;  ///< per surface, the pixels of the block that it reaches
    std::vector<LayerSums> sums_;
    std::vector<LayerTerm> terms_;
    std::vector<std::int32_t> first_;  ///< per pixel, index in entries_ of its last fragment; -1 if none
    std::vector<Entry> entries_;
    std::vector<Fragment> fragments_;
};

void BlockLayers::push(int x, int y, const Fragment& fragment) {
    std::int32_t& first =
        first_[static_cast<std::size_t>(y - rows_.y_begin) * static_cast<std::size_t>(rows_.width()) +
               static_cast<std::size_t>(x - rows_.x_begin)];
    entries_.push_back({fragment, first});
    first = static_cast<std::int32_t>(entries_.size()) - 1;
}

void BlockLayers::add_surface(std::span<const PartCells> parts, std::span<const std::uint32_t> cells,
                              std::size_t channel, bool with_lens) {
    if (sums_.size() < parts.size()) sums_.resize(parts.size());
    RasterWindow all{};
    bool any = false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const PartCells& part = parts[i];
        const RasterWindow reach = common(part.reach, rows_);
        if (reach.width() <= 0 || reach.height() <= 0) {
            sums_[i].begin({}, false);
            continue;
        }
        if (part.part->path == 0) {
            all = any ? around(all, reach) : reach;
            any = true;
        }
        sums_[i].begin(reach, with_lens && wants_lens(*part.part), splats_.from_anchor_px());
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const LayerCell& cell = splats_.cells()[cells[k]];
            if (!meet(cell.reach, rows_)) continue;
            const std::span<const LayerRun> runs = splats_.runs(cell);
            for (std::size_t r = 0; r < runs.size(); ++r) {
                if (r + 1 < runs.size()) __builtin_prefetch(splats_.splats(runs[r + 1]).data());
                sums_[i].add(splats_.splats(runs[r]), splats_.kernels(), channel);
            }
        }
        sums_[i].finish();
    }
    if (!any) return;
    for (int y = all.y_begin; y < all.y_end; ++y) {
        for (int x = all.x_begin; x < all.x_end; ++x) {
            terms_.clear();
            for (std::size_t i = 0; i < parts.size(); ++i) {
                const RasterWindow& r = sums_[i].rows();
                if (y < r.y_begin || y >= r.y_end || x < r.x_begin || x >= r.x_end) continue;
                const double* sums = sums_[i].at(x, y);
                if (!(sums[3] > smallest_layer_weight)) continue;
                terms_.push_back({parts[i].part,
                                  {sums[0], sums[1], sums[2]},
                                  sums[3],
                                  sums_[i].depth_at(x, y),
                                  sums_[i].lens_at(x, y),
                                  sums_[i].covered_at(x, y)});
            }
            if (terms_.empty()) continue;
            if (const auto fragment = resolve_surface(terms_, splats_.geometry())) push(x, y, *fragment);
        }
    }
}

void BlockLayers::store_pixels(std::size_t channel, Image& image) {
    const RasterWindow& picture = splats_.picture();
    for (int y = rows_.y_begin; y < rows_.y_end; ++y) {
        for (int x = rows_.x_begin; x < rows_.x_end; ++x) {
            fragments_.clear();
            const auto pixel =
                static_cast<std::size_t>(y - rows_.y_begin) * static_cast<std::size_t>(rows_.width()) +
                static_cast<std::size_t>(x - rows_.x_begin);
            for (std::int32_t i = first_[pixel]; i >= 0; i = entries_[static_cast<std::size_t>(i)].next)
                fragments_.push_back(entries_[static_cast<std::size_t>(i)].fragment);
            std::reverse(fragments_.begin(), fragments_.end());
            store(splats_, fragments_, x, y, channel, image.pixel(x - picture.x_begin, y - picture.y_begin));
        }
    }
}

bool BlockLayers::meets_another(std::size_t surface) const {
    constexpr std::size_t few = 64;
    if (surfaces_.size() > few) return true;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
        if (i != surface && meet(surfaces_[i], surfaces_[surface])) return true;
    }
    return false;
}

void BlockLayers::run(const Block& of, Image& image) {
    const RasterWindow& block = of.window;
    find_parts(splats_, of, parts_);
    std::vector<std::size_t> begins;  // first part of each surface
    surfaces_.clear();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (i == 0 || parts_[i].part->surface != parts_[i - 1].part->surface) {
            begins.push_back(i);
            surfaces_.push_back(parts_[i].reach);
        } else if (parts_[i].part->path == 0) {
            surfaces_.back() = around(surfaces_.back(), parts_[i].reach);
        }
    }
    const std::size_t surfaces = begins.size();
    begins.push_back(parts_.size());
    std::size_t most_parts = 1;
    for (std::size_t i = 0; i < surfaces; ++i) most_parts = std::max(most_parts, begins[i + 1] - begins[i]);
    const std::size_t per_row = std::max(surfaces, most_parts) * static_cast<std::size_t>(block.width());
    const int rows = static_cast<int>(
        std::clamp<std::size_t>(most_sums / std::max<std::size_t>(per_row, 1), 1, block_height));
    for (int y = block.y_begin; y < block.y_end; y += rows) {
        rows_ = {block.x_begin, block.x_end, y, std::min(y + rows, block.y_end)};
        for (std::size_t channel = 0; channel < splats_.kernels().channels(); ++channel) {
            entries_.clear();
            first_.assign(static_cast<std::size_t>(rows_.width()) * static_cast<std::size_t>(rows_.height()),
                          -1);
            for (std::size_t i = 0; i < surfaces; ++i) {
                add_surface(std::span(parts_).subspan(begins[i], begins[i + 1] - begins[i]), of.cells,
                            channel, meets_another(i));
            }
            store_pixels(channel, image);
        }
    }
}

}  // namespace

void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted) {
    const RasterWindow& picture = splats.picture();
    if (image.width != picture.width() || image.height != picture.height())
        image = Image(picture.width(), picture.height());
    const std::vector<Block> blocks = blocks_of(splats);
    tbb::enumerable_thread_specific<BlockLayers> workers([&] { return BlockLayers(splats); });
    Progress progress("layers", blocks.size());
    parallel_for(blocks.size(), [&](std::size_t i) {
        progress.advance();
        const RasterWindow& block = blocks[i].window;
        if (!wanted || wanted->meets(block.x_begin - picture.x_begin, block.y_begin - picture.y_begin,
                                     block.width(), block.height()))
            workers.local().run(blocks[i], image);
    });
}

namespace {

/// The light that the blurred samples of one surface, or of one mirror image, add to each pixel, as
/// layers_reference() computes it. There is one element per pixel.
using ReferenceSums = std::vector<LayerTerm>;

void add_reference(const LayerSplats& splats, const LayerSplat& s, const LayerPart& part, std::size_t channel,
                   ReferenceSums& sums) {
    const RasterWindow& p = splats.picture();
    const Kernel& kernel = splats.kernels().kernel(s.kernel, channel);
    for (int y = std::max(s.y + kernel.y_begin, p.y_begin); y < std::min(s.y + kernel.y_end(), p.y_end);
         ++y) {
        const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
        for (int x = std::max(s.x + row.x_begin, p.x_begin); x < std::min(s.x + row.x_end, p.x_end); ++x) {
            const int dx = x - s.x;
            const bool inner = dx >= row.inner_begin && dx < row.inner_end;
            const int skipped =
                dx < row.inner_begin ? row.x_begin : row.x_begin + row.inner_end - row.inner_begin;
            const auto share = static_cast<double>(
                inner ? kernel.inner : kernel.taps[row.tap + static_cast<std::uint32_t>(dx - skipped)]);
            LayerTerm& sum =
                sums[static_cast<std::size_t>(y - p.y_begin) * static_cast<std::size_t>(p.width()) +
                     static_cast<std::size_t>(x - p.x_begin)];
            const std::array<float, 4> value{s.r, s.g, s.b, s.weight};
            const double to_middle = 0.5 - splats.from_anchor_px();
            const LensMoment lens{(dx + to_middle) * static_cast<double>(s.lens_per_px),
                                  (y - s.y + to_middle) * static_cast<double>(s.lens_per_px)};
            for (std::size_t c = 0; c < 4; ++c) {
                const double light = share * static_cast<double>(value[c]);
                (c < 3 ? sum.rgb[c] : sum.weight) += light;
                if (!wants_lens(part)) continue;
                LensMoment& moment = c < 3 ? sum.lens.rgb : sum.lens.alpha;
                moment.x += light * lens.x;
                moment.y += light * lens.y;
            }
            sum.depth += share * static_cast<double>(s.depth);
            sum.covered += share * static_cast<double>(s.covered);
        }
    }
}

}  // namespace

Image layers_reference(const LayerSplats& splats) {
    const RasterWindow& p = splats.picture();
    Image image(p.width(), p.height());
    for (std::size_t channel = 0; channel < splats.kernels().channels(); ++channel) {
        std::vector<ReferenceSums> sums(splats.parts().size(), ReferenceSums(image.rgb.size() / 3));
        for (const LayerCell& cell : splats.cells()) {
            for (const LayerRun& run : splats.runs(cell)) {
                for (const LayerSplat& s : splats.splats(run))
                    add_reference(splats, s, splats.parts()[cell.part], channel, sums[cell.part]);
            }
        }
        for (std::size_t i = 0; i < image.rgb.size() / 3; ++i) {
            std::vector<Fragment> fragments;
            std::vector<LayerTerm> terms;
            for (std::size_t k = 0; k < sums.size(); ++k) {
                const LayerPart& part = splats.parts()[k];
                if (sums[k][i].weight > smallest_layer_weight) {
                    terms.push_back(sums[k][i]);
                    terms.back().part = &part;
                }
                if (k + 1 < sums.size() && splats.parts()[k + 1].surface == part.surface) continue;
                if (const auto f = resolve_surface(terms, splats.geometry())) fragments.push_back(*f);
                terms.clear();
            }
            const auto x = static_cast<int>(i % static_cast<std::size_t>(p.width())),
                       y = static_cast<int>(i / static_cast<std::size_t>(p.width()));
            store(splats, fragments, p.x_begin + x, p.y_begin + y, channel, image.rgb.data() + 3 * i);
        }
    }
    return image;
}

}  // namespace postlens
