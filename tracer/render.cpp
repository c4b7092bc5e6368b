#include "tracer/render.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "core/error.h"
#include "core/files/output_file.h"
#include "core/memory.h"
#include "core/progress.h"
#include "core/threads.h"
#include "pictures/crop.h"
#include "pictures/picture_part.h"
#include "tracer/distributed/eye_rays.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/distributed/render_state.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int tile_px = 8;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Renders an image in tiles, a few samples per pixel at a time.
// Radiance is always added in the same order, so neither threads nor interruptions change the image.
class Renderer {
  public:
    Renderer(const RenderSetup& setup, const RenderSettings& settings, RenderState& state)
        : setup_(setup),
          state_(state),
          halves_(settings.halves ? 2 : 1),
          spp_(settings.spp / halves_),
          group_(std::min(spp_, RayBatch::group)),
          groups_((spp_ + group_ - 1) / group_),
          block_groups_((groups_ + most_sample_blocks - 1) / most_sample_blocks),
          end_(groups_),
          columns_((setup.width() + tile_px - 1) / tile_px),
          is_part_(settings.sample_share.has_value()) {
        if (settings.sample_share) {
            const Blocks blocks = blocks_of(settings);
            begin_ = blocks.begin * block_groups_;
            end_ = std::min(groups_, blocks.end * block_groups_);
        }
        const auto all = static_cast<std::size_t>(columns_) *
                         static_cast<std::size_t>((setup.height() + tile_px - 1) / tile_px);
        for (std::size_t i = 0; i < all; ++i) {
            const auto [x, y] = corner(i);
            if (!settings.crop || settings.crop->meets(x, y, tile_px, tile_px)) tiles_.push_back(i);
        }
        for (int h = 0; h < halves_; ++h) {
            // With --halves, the samples form two independent halves, each with its own seed. The seeds are
            // hashed, so that renders with neighbouring --seed values have no half in common.
            const std::uint64_t seed = settings.halves
                                           ? mix64(settings.seed * 2 + static_cast<std::uint64_t>(h) + 1)
                                           : settings.seed;
            samplers_.push_back(std::make_unique<Sampler>(settings.sampler, spp_, seed));
            tracers_.push_back(
                std::make_unique<DistributedTracer>(setup.rays(), *samplers_.back(), settings.tracing));
        }
    }

    /// Divides a pixel's samples into groups of up to 16, which are traced together, and these groups into
    /// blocks. If several program runs share the work, each run renders some of the blocks of every pixel.
    /// Returns the number of blocks per pixel and the number of groups per block.
    static std::pair<int, int> division(int spp_asked, bool halves) {
        const int spp = spp_asked / (halves ? 2 : 1), group = std::min(spp, RayBatch::group),
                  groups = (spp + group - 1) / group,
                  block = (groups + most_sample_blocks - 1) / most_sample_blocks;
        return {(groups + block - 1) / block, block};
    }
    /// The samples of every pixel are divided into blocks. This run renders the blocks [begin, end). With
    /// --share, other runs render the other blocks.
    struct Blocks {
        int begin = 0, end = 0;
        bool with_open = false;  ///< a block has several groups of samples, and blocks are added to one sum
    };
    static Blocks blocks_of(const RenderSettings& settings) {
        const auto [blocks, block] = division(settings.spp, settings.halves);
        if (!settings.sample_share) return {0, blocks, block > 1};
        const auto [index, count] = *settings.sample_share;
        static_cast<void>(sample_blocks(count, settings.spp, settings.halves));  // refuses too many shares
        return {blocks * index / count, blocks * (index + 1) / count, false};
    }
    static RenderState state_for(const RenderSetup& setup, const RenderSettings& settings, double stops,
                                 const std::string& what) {
        const int halves = settings.halves ? 2 : 1;
        const Blocks blocks = blocks_of(settings);
        const int apart = settings.sample_share ? blocks.end - blocks.begin : 1;
        require_memory(RenderState::bytes(setup.width(), setup.height(), halves, apart, blocks.with_open),
                       what);
        return {setup.width(), setup.height(), halves, stops, apart, blocks.with_open};
    }

    [[nodiscard]] int rounds() const { return (end_ - begin_) * halves_; }
    [[nodiscard]] std::size_t tiles() const { return tiles_.size(); }
    [[nodiscard]] const RayCounts& counts() const { return counts_; }

    // Returns the number of finished samples per pixel, which is equal for all pixels of a tile.
    [[nodiscard]] std::uint32_t samples_done(std::size_t tile) const {
        const std::size_t pixel = first_pixel(tile);
        return state_.samples[0][pixel] + (halves_ == 2 ? state_.samples[1][pixel] : 0);
    }

    [[nodiscard]] int rounds_done(std::size_t tile) const {
        const std::size_t pixel = first_pixel(tile);
        int done = 0;
        for (std::size_t h = 0; h < static_cast<std::size_t>(halves_); ++h)
            done += static_cast<int>((state_.samples[h][pixel] + static_cast<unsigned>(group_) - 1) /
                                     static_cast<unsigned>(group_));
        return done;
    }

    // Traces one round of samples in the tiles [begin, end). In a round, each pixel gets up to 16 samples.
    // `round` is the number of the round. A tile that already has the samples of this round, because an
    // interrupted render is resumed, is skipped.
    void trace(int round, std::size_t begin, std::size_t end) {
        std::vector<RayCounts> counts(end - begin);
        const auto add_up = [&] {
            for (const RayCounts& c : counts) counts_ += c;
        };
        try {
            parallel_for(end - begin, [&](std::size_t i) {
                if (rounds_done(begin + i) == round) trace_tile(begin + i, round, counts[i]);
            });
        } catch (...) {
            add_up();  // the state contains the samples that were traced before the interruption
            throw;
        }
        add_up();
    }

  private:
    [[nodiscard]] std::size_t first_pixel(std::size_t tile) const {
        const auto [x, y] = corner(tiles_[tile]);
        return index(x, y);
    }

    // Returns the upper left pixel of a tile, which is given by its index among all tiles of the image.
    [[nodiscard]] std::pair<int, int> corner(std::size_t tile) const {
        return {static_cast<int>(tile % static_cast<std::size_t>(columns_)) * tile_px,
                static_cast<int>(tile / static_cast<std::size_t>(columns_)) * tile_px};
    }

    void trace_tile(std::size_t tile, int round, RayCounts& counts) {
        thread_local EyeRays eye;
        const auto half = static_cast<std::size_t>(round % halves_);
        const int group = begin_ + round / halves_, first = group * group_,
                  count = std::min(group_, spp_ - first);
        const auto [x0, y0] = corner(tiles_[tile]);
        const int x1 = std::min(x0 + tile_px, setup_.width()), y1 = std::min(y0 + tile_px, setup_.height());
        thread_local std::vector<std::uint32_t> pixels;
        pixels.clear();
        for (int y = y0; y < y1; ++y) {
            for (int x = x0; x < x1; ++x) pixels.push_back(static_cast<std::uint32_t>(index(x, y)));
        }
        make_eye_rays(setup_, *samplers_[half], tracers_[half]->needs_times(), pixels, first, count, eye);
        tracers_[half]->trace(eye, counts);
        const bool block_ends = (group + 1) % block_groups_ == 0 || group + 1 == groups_;
        const std::size_t pixels_of_block = 3 * state_.samples[half].size();
        const auto block = static_cast<std::size_t>(is_part_ ? (group - begin_) / block_groups_ : 0);
        std::size_t ray = 0;
        for (const std::uint32_t pixel : pixels) {
            double* sum = state_.sums[half].data() + block * pixels_of_block + 3 * std::size_t{pixel};
            double* open =
                state_.open[half].empty() ? nullptr : state_.open[half].data() + 3 * std::size_t{pixel};
            // `of_block` is the sum of one block of a pixel's samples. The option --share divides the blocks
            // among several program runs, and their sums are added later. So that the image is bit-identical
            // with and without --share, the same numbers must be added in the same order. Therefore, without
            // --share, too, each block is summed separately before it is added to the pixel's sum.
            glm::dvec3 of_block = open == nullptr ? glm::dvec3(0) : glm::dvec3(open[0], open[1], open[2]);
            if (is_part_) of_block = glm::dvec3(sum[0], sum[1], sum[2]);
            for (int i = 0; i < count; ++i, ++ray) {
                of_block += eye.weight.empty() ? eye.radiance[ray]
                                               : static_cast<double>(eye.weight[ray]) * eye.radiance[ray];
            }
            if (is_part_) {
                for (int c = 0; c < 3; ++c) sum[c] = of_block[c];
            } else if (open != nullptr && !block_ends) {
                for (int c = 0; c < 3; ++c) open[c] = of_block[c];
            } else {
                for (int c = 0; c < 3; ++c) sum[c] += of_block[c];
                if (open != nullptr) std::fill_n(open, 3, 0.0);
            }
            state_.samples[half][pixel] += static_cast<std::uint32_t>(count);
        }
    }

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(setup_.width()) +
               static_cast<std::size_t>(x);
    }

    const RenderSetup& setup_;
    RenderState& state_;
    int halves_, spp_, group_, groups_;
    int block_groups_;     ///< groups of samples in a block
    int begin_ = 0, end_;  ///< the groups to render
    int columns_;
    bool is_part_;                    ///< the state stores the sum of every block separately
    std::vector<std::size_t> tiles_;  ///< the tiles to render, as indices in the whole image
    std::vector<std::unique_ptr<Sampler>> samplers_;
    std::vector<std::unique_ptr<DistributedTracer>> tracers_;
    RayCounts counts_;
};

// Renders all samples that are still missing. Several times a second, all threads stop, and `pause` is
// called, for instance to save the image.
void trace_all(Renderer& renderer, const std::function<void()>& pause) {
    std::uint64_t left = 0;
    int first = renderer.rounds();
    for (std::size_t t = 0; t < renderer.tiles(); ++t) {
        const int done = renderer.rounds_done(t);
        left += static_cast<std::uint64_t>(renderer.rounds() - done);
        first = std::min(first, done);
    }
    Progress progress("render", left);
    std::size_t slice = 64;
    for (int round = first; round < renderer.rounds(); ++round) {
        for (std::size_t begin = 0; begin < renderer.tiles();) {
            throw_if_interrupted();
            const std::size_t end = std::min(begin + slice, renderer.tiles());
            const auto start = Clock::now();
            renderer.trace(round, begin, end);
            const double took_s = seconds_since(start);
            progress.advance(end - begin);
            // The image is rendered in slices, each of which is a number of tiles that are rendered in
            // parallel. A slice should take 0.1 to 0.4 s. A shorter slice wastes time on starting threads,
            // and a longer one delays stopping and saving.
            if (took_s < 0.1) slice = std::min<std::size_t>(2 * slice, 1U << 16);
            if (took_s > 0.4) slice = std::max<std::size_t>(slice / 2, 16);
            begin = end;
            pause();
        }
    }
}

RenderResult finish(const RenderSetup& setup, const RenderSettings& settings, const Renderer& renderer,
                    const RenderState& state) {
    RenderResult out;
    out.image = state.picture();
    if (settings.halves) out.halves = {state.half(0), state.half(1)};
    out.rays = renderer.counts();
    out.focal_length_mm = setup.lens().focal_length_mm;
    out.f_number = setup.lens().f_number;
    out.focus_m = setup.focus_m();
    out.motion_error_px = setup.rays().motion_error_px();
    return out;
}

fs::path with_word(const fs::path& path, const std::string& word, const std::string& ending) {
    return path.parent_path() / (path.stem().string() + "." + word + ending);
}

}  // namespace

int sample_blocks(int shares, int spp, bool halves) {
    const int blocks = Renderer::division(spp, halves).first;
    if (shares > blocks) {
        fail(ExitCode::wrong_arguments,
             "--share: more shares than the samples can be divided into (got {}; expected {} or less for {} "
             "samples a pixel, or --share-by rows)",
             shares, blocks, spp);
    }
    return blocks;
}

std::array<fs::path, 2> half_paths(const fs::path& path) {
    return {with_word(path, "a", path.extension().string()), with_word(path, "b", path.extension().string())};
}

fs::path partial_path(const fs::path& path) {
    return with_word(path, "partial", ".exr");
}

RenderResult render_picture(const Scene& scene, const RenderSettings& settings) {
    const RenderSetup setup(scene, settings);
    check_crop(settings.crop, setup.width(), setup.height());
    RenderState state = Renderer::state_for(setup, settings, scene.exposure_stops, "the picture");
    Renderer renderer(setup, settings, state);
    const auto start = Clock::now();
    trace_all(renderer, [] {});
    RenderResult out = finish(setup, settings, renderer, state);
    out.seconds_render = seconds_since(start);
    return out;
}

RenderResult render_to_file(const Scene& scene, const RenderSettings& settings, const fs::path& path) {
    const fs::path partial = partial_path(path);
    check_image_path(path);
    for (const fs::path& target : {path, partial}) const OutputFile writable(target);

    const RenderSetup setup(scene, settings);
    check_crop(settings.crop, setup.width(), setup.height());
    RenderState state =
        Renderer::state_for(setup, settings, scene.exposure_stops, path.string() + ": the picture");
    std::string fingerprint = setup.fingerprint(settings);
    if (settings.sample_share)
        fingerprint += fmt::format(" {}/{}", (*settings.sample_share)[0], (*settings.sample_share)[1]);
    const bool resumes = settings.resume && fs::exists(partial);
    if (resumes) read_state(partial, fingerprint, state);
    Renderer renderer(setup, settings, state);
    int spp_resumed = 0;
    if (resumes) {
        std::uint32_t least = ~0U;
        for (std::size_t t = 0; t < renderer.tiles(); ++t) least = std::min(least, renderer.samples_done(t));
        spp_resumed = static_cast<int>(least);
    }
    const auto start = Clock::now();
    auto saved = start;
    constexpr double least_interval_s = 5;  // between two saves of the unfinished image
    double interval_s = least_interval_s;
    const auto save = [&] {
        const auto began = Clock::now();
        write_state(partial, state, fingerprint);
        saved = Clock::now();
        // Saving takes at most a twentieth of the time.
        interval_s = std::max(least_interval_s, 20 * seconds_since(began));
    };
    try {
        trace_all(renderer, [&] {
            if (seconds_since(saved) >= interval_s) save();
        });
    } catch (const Error& e) {
        if (e.code() != ExitCode::interrupted) throw;
        save();
        fail(ExitCode::interrupted, "interrupted; {} holds the picture so far, and --resume goes on from it",
             partial.string());
    }
    RenderResult out = finish(setup, settings, renderer, state);
    out.seconds_render = seconds_since(start);
    out.resumed = resumes;
    out.spp_resumed = spp_resumed;
    if (settings.sample_share) {
        write_state(path, state, fingerprint, settings.part_mark);
        std::error_code none;
        fs::remove(partial, none);
        return out;
    }
    const auto write = [&](const fs::path& to, Image& image) {
        image.made_by = settings.made_by;
        if (!settings.part_mark.empty()) mark_as_part(image, settings.crop, settings.part_mark);
        write_image(to, image, settings.crop);
    };
    if (settings.halves) {
        const auto paths = half_paths(path);
        for (std::size_t h = 0; h < 2; ++h) write(paths[h], out.halves[h]);
    }
    write(path, out.image);
    std::error_code none;
    fs::remove(partial, none);
    return out;
}

}  // namespace postlens
