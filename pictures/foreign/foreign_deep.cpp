// Part of ForeignFile: reads the pixels of deep parts.
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <algorithm>

#include "core/job.h"
#include "core/memory.h"
#include "pictures/foreign/foreign_file_impl.h"

namespace postlens {

using namespace foreign;

namespace {

/// A band of rows of a deep part, in the layout of the OpenEXR library: a sample count for each pixel, and a
/// pointer for each pixel and channel.
class DeepBand {
  public:
    DeepBand(const ForeignPart& part, const Imf::Header& h, std::span<const std::string> channels,
             std::uint64_t file_bytes, const std::string& name)
        : part_(part), channels_(channels), file_bytes_(file_bytes), name_(name) {
        for (const std::string& c : channels) types_.push_back(read_as(h, c, name));
    }

    template <typename Input, typename Counts, typename Pixels>
    void read(Input& in, int y_begin, int y_end, const Counts& counts, const Pixels& pixels,
              const std::function<void(const DeepRows&)>& take) {
        throw_if_interrupted();
        const auto width = static_cast<std::size_t>(part_.width());
        const std::size_t count = width * static_cast<std::size_t>(y_end - y_begin);
        require_memory(count * (sizeof(std::uint32_t) + channels_.size() * sizeof(float*)),
                       "a band of pixels");
        counts_.assign(count, 0);
        pointers_.assign(channels_.size(), std::vector<float*>(count, nullptr));
        in.setFrameBuffer(frame(y_begin, width));
        counts(in);
        check_counts();
        place(count);
        pixels(in);
        DeepRows rows{.y_begin = y_begin, .y_end = y_end, .count = counts_, .values = {}};
        for (const auto& v : values_) rows.values.emplace_back(v);
        take(rows);
    }

  private:
    Imf::DeepFrameBuffer frame(int y_begin, std::size_t width) {
        const std::ptrdiff_t origin =
            -(static_cast<std::ptrdiff_t>(y_begin) * static_cast<std::ptrdiff_t>(width) + part_.data.x_min);
        Imf::DeepFrameBuffer out;
        out.insertSampleCountSlice(Imf::Slice(Imf::UINT,
                                              reinterpret_cast<char*>(counts_.data()) +
                                                  origin * static_cast<std::ptrdiff_t>(sizeof(std::uint32_t)),
                                              sizeof(std::uint32_t), sizeof(std::uint32_t) * width));
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            out.insert(channels_[c], Imf::DeepSlice(types_[c],
                                                    reinterpret_cast<char*>(pointers_[c].data()) +
                                                        origin * static_cast<std::ptrdiff_t>(sizeof(float*)),
                                                    sizeof(float*), sizeof(float*) * width, sizeof(float)));
        }
        return out;
    }
    void check_counts() {
        std::uint64_t total = 0;
        for (const std::uint32_t n : counts_) total += n;
        const std::uint64_t bytes = total * channels_.size() * sizeof(float);
        if (bytes > unquestioned_bytes && bytes / densest > file_bytes_) {
            fail(ExitCode::invalid_input, "{}: sample counts are damaged (got {} samples in {} bytes)", name_,
                 total, file_bytes_);
        }
        require_memory(bytes, "a band of samples");
        total_ = total;
    }
    void place(std::size_t count) {
        values_.assign(channels_.size(), std::vector<float>(total_));
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            float* at = values_[c].data();
            for (std::size_t i = 0; i < count; ++i) {
                pointers_[c][i] = at;
                at += counts_[i];
            }
        }
    }

    const ForeignPart& part_;
    std::span<const std::string> channels_;
    std::uint64_t file_bytes_;
    const std::string& name_;
    std::vector<Imf::PixelType> types_;
    std::vector<std::uint32_t> counts_;
    std::vector<std::vector<float*>> pointers_;
    std::vector<std::vector<float>> values_;
    std::uint64_t total_ = 0;
};

/// Checks the sizes that the chunks (blocks of rows, or tiles) of a deep file state, because a wrong size
/// could make the OpenEXR library exhaust the memory. The file is opened a second time, because such a query
/// moves the library's read position.
class StoredChunks {
  public:
    StoredChunks(const std::string& name, std::uint64_t file_bytes, int number, bool tiled)
        : name_(name), file_bytes_(file_bytes), file_(name.c_str(), 0, false) {
        if (tiled) {
            tiles_.emplace(file_, number);
        } else {
            rows_.emplace(file_, number);
        }
    }
    void check_row(int y) {
        std::uint64_t bytes = 0;
        rows_->rawPixelData(y, nullptr, bytes);
        check(bytes);
    }
    void check_tile(int x, int y) {
        int level_x = 0, level_y = 0;
        std::uint64_t bytes = 0;
        tiles_->rawTileData(x, y, level_x, level_y, nullptr, bytes);
        check(bytes);
    }

  private:
    void check(std::uint64_t bytes) const {
        if (bytes > file_bytes_) {
            fail(ExitCode::invalid_input, "{}: a chunk is damaged (got {} bytes in a file of {})", name_,
                 bytes, file_bytes_);
        }
    }

    const std::string& name_;
    std::uint64_t file_bytes_;
    Imf::MultiPartInputFile file_;
    std::optional<Imf::DeepScanLineInputPart> rows_;
    std::optional<Imf::DeepTiledInputPart> tiles_;
};

}  // namespace

void ForeignFile::read_deep(std::size_t part, std::span<const std::string> channels,
                            const std::function<void(const DeepRows&)>& take) const {
    const ForeignPart& p = parts_[part];
    const std::string& name = name_of(part);
    guarded(name, [&] {
        const Imf::Header& h = impl_->header(part);
        const Impl::Opened& opened = impl_->of(part);
        const int number = impl_->number(part);
        DeepBand band(p, h, channels, opened.bytes, name);
        StoredChunks stored(name, opened.bytes, number, p.tiled);
        if (p.tiled) {
            Imf::DeepTiledInputPart in(*opened.file, number);
            const int rows = static_cast<int>(in.tileYSize()), last_column = in.numXTiles(0) - 1;
            for (int t = 0; t < in.numYTiles(0); ++t) {
                const int y = p.data.y_min + t * rows;
                for (int column = 0; column <= last_column; ++column) stored.check_tile(column, t);
                band.read(
                    in, y, std::min(y + rows, p.data.y_max + 1),
                    [&](auto& from) { from.readPixelSampleCounts(0, last_column, t, t); },
                    [&](auto& from) { from.readTiles(0, last_column, t, t); }, take);
            }
            return;
        }
        Imf::DeepScanLineInputPart in(*opened.file, number);
        constexpr int rows = 16;
        for (int y = p.data.y_min; y <= p.data.y_max; y += rows) {
            const int last = std::min(y + rows - 1, p.data.y_max);
            for (int row = y; row <= last; row += chunk_rows(h)) stored.check_row(row);
            band.read(
                in, y, last + 1, [&](auto& from) { from.readPixelSampleCounts(y, last); },
                [&](auto& from) { from.readPixels(y, last); }, take);
        }
    });
}

}  // namespace postlens
