#include "focus/foreign_focus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <tbb/enumerable_thread_specific.h>
#include <type_traits>

#include "core/error.h"
#include "core/text.h"
#include "core/threads.h"
#include "focus/foreign/behind_fill.h"
#include "focus/foreign/border_extension.h"
#include "focus/foreign/stack_field.h"
#include "focus/foreign/stack_lights.h"
#include "focus/layers/layers.h"
#include "focus/lens_model.h"
#include "focus/overscan.h"
#include "focus/reframe.h"
#include "focus/scatter/scatter.h"
#include "pictures/aperture_file.h"
#include "pictures/crop.h"
#include "reproject/fill_gaps.h"

namespace postlens {
namespace {

/// Number of rows that one task converts to PixelLight.
constexpr std::size_t rows_per_task = 4;

DepthRange depth_range(const ForeignPicture& picture) {
    struct Inverses {
        float nearest = 0, farthest = std::numeric_limits<float>::infinity();
    };
    constexpr std::size_t samples_per_task = std::size_t{1} << 16;
    std::vector<Inverses> of_task(picture.samples.size() / samples_per_task + 1);
    parallel_for(of_task.size(), [&](std::size_t task) {
        Inverses range;
        const std::size_t begin = task * samples_per_task;
        for (const StackSample& s :
             std::span(picture.samples)
                 .subspan(begin, std::min(samples_per_task, picture.samples.size() - begin))) {
            const float inverse_z = s.spread_inverse_z();
            if (inverse_z == 0) continue;
            range.nearest = std::max(range.nearest, inverse_z);
            range.farthest = std::min(range.farthest, inverse_z);
        }
        of_task[task] = range;
    });
    float nearest = 0, farthest = std::numeric_limits<float>::infinity();
    for (const Inverses& range : of_task) {
        nearest = std::max(nearest, range.nearest);
        farthest = std::min(farthest, range.farthest);
    }
    DepthRange out;
    if (nearest > 0) {
        out.nearest_m = 1 / static_cast<double>(nearest);
        out.farthest_m = 1 / static_cast<double>(farthest);
    }
    return out;
}

RasterWindow known_corners(const ForeignPicture& p) {
    RasterWindow out = known_pixels(p);
    ++out.x_end;
    ++out.y_end;
    return out;
}

struct Frame {
    RasterWindow window;
    double zoom = 1;
};

Frame framed(const ForeignPicture& p, Framing framing, const FocusGeometry& geometry) {
    if (framing == Framing::keep) return {{0, p.width, 0, p.height}, 1};
    const Frame out{window_for_zoom(p.width, p.height, geometry.zoom), geometry.zoom};
    const RasterWindow known = known_corners(p);
    const RasterWindow& w = out.window;
    if (w.x_begin < known.x_begin || w.y_begin < known.y_begin || w.x_end > known.x_end - 1 ||
        w.y_end > known.y_end - 1) {
        fail(ExitCode::wrong_arguments,
             "the picture's field of view is too narrow for this framing (got a film at {:.6g} mm; expected "
             "{:.6g} "
             "mm or more, or the framing kept)",
             geometry.zoom * p.camera.film_distance_mm, p.camera.film_distance_mm);
    }
    return out;
}

/// Summary of the estimated surfaces behind some pixels.
struct Guessed {
    std::size_t known = 0;        ///< pixels with an estimate
    bool is_see_through = false;  ///< whether empty space is visible behind one of the surfaces

    void add(const Guessed& other) {
        known += other.known;
        is_see_through = is_see_through || other.is_see_through;
    }
};

Guessed guessed(std::span<const Behind> behind) {
    Guessed out;
    for (const Behind& b : behind) out.add({b.known ? 1U : 0U, b.known && b.alpha < 1});
    return out;
}

bool ends_in_nothing(const Behind& behind, double open) {
    return !behind.known && !behind.fills && open > opaque_transmittance;
}

std::optional<FocusWarning> guessed_warning(const Guessed& guessed, const ForeignPicture& picture) {
    if (guessed.known == 0) return {};
    const double share = static_cast<double>(guessed.known) / static_cast<double>(picture.offsets.size() - 1);
    return FocusWarning{
        "uncovered", share,
        fmt::format("what stands behind {} % of the pixels may come to light and is not in the "
                    "picture: filled in from around",
                    rough(100 * share))};
}

/// Computes the image that a lens forms of another program's image, with the method `scatter` or `layers`.
/// First, the colours are blurred. If the result is translucent, alpha is blurred separately, in the same
/// way.
class Spread {
  public:
    Spread(const ForeignPicture& picture, const FocusSettings& settings, const FocusGeometry& geometry,
           const LensView* view, const RasterWindow& window, const std::optional<Crop>& crop)
        : picture_(picture),
          crop_(crop),
          method_(settings.method),
          geometry_(geometry),
          window_(window),
          corners_(known_corners(picture)),
          depths_(depth_range(picture)),
          levels_(geometry, depths_, settings.spacing, settings.depths),
          reach_(geometry) {
        const double half_diagonal_px = std::hypot(corners_.width(), corners_.height()) / 2.0;
        response_ = view != nullptr
                        ? lens_model(*view, geometry, half_diagonal_px,
                                     1 / depths_.nearest_m.value_or(std::numeric_limits<double>::infinity()))
                        : std::shared_ptr<const ResponseModel>(response_model(
                              settings.impulse, geometry, std::hypot(window.width(), window.height()) / 2.0));
        if (has_points(settings.impulse)) reach_ = around_aperture(geometry, read_aperture(settings.impulse));
        if (method_ == FocusMethod::layers) {
            behind_.emplace(picture, reach_, std::abs(response_->spherical_px()));
            border_.emplace(picture, reach_, std::abs(response_->spherical_px()));
        } else {
            nothing_ = nothing_in_reach(picture, geometry, window, std::abs(response_->spherical_px()));
        }
    }

    [[nodiscard]] FocusResult picture() {
        FocusResult out;
        out.method = method_;
        const Guessed guessed = spread(StackValue::colour, out.image, &out);
        if (guessed.is_see_through || !picture_.is_opaque()) {
            Image alpha;
            (void)spread(StackValue::alpha, alpha, nullptr);
            out.image.alpha.resize(alpha.rgb.size() / 3);
            for (std::size_t i = 0; i < out.image.alpha.size(); ++i)
                out.image.alpha[i] = std::clamp(alpha.rgb[3 * i + 1], 0.0F, 1.0F);
        }
        if (auto warning = guessed_warning(guessed, picture_)) out.warnings.push_back(*std::move(warning));
        return out;
    }

  private:
    template <typename Splats>
    [[nodiscard]] Guessed take_in(Splats& splats, StackValue value) const {
        const RasterWindow source = source_pixels();
        const auto rows = static_cast<std::size_t>(source.height());
        const auto width = static_cast<std::size_t>(picture_.x_end - picture_.x_begin);
        std::vector<Guessed> found((rows + rows_per_task - 1) / rows_per_task);
        // Each thread reuses its memory for every row, because the first write to new memory is slow.
        struct Workplace {
            StackLights lights;
            std::vector<PixelLight> row;
            std::vector<Behind> behind_row;
            std::vector<StackSample> continued;
        };
        tbb::enumerable_thread_specific<Workplace> workplaces([&] {
            return Workplace{{geometry_, method_ == FocusMethod::layers}, {}, {}, {}};
        });
        parallel_for(found.size(), [&](std::size_t task) {
            auto& [lights, row, behind_row, continued] = workplaces.local();
            const std::size_t end = std::min(rows, (task + 1) * rows_per_task);
            for (std::size_t i = task * rows_per_task; i < end; ++i) {
                const int y = source.y_begin + static_cast<int>(i);
                row.clear();
                behind_row.clear();
                // Row y may lie above or below the image, and then contains only surfaces that are extended
                // beyond the image border. Nothing is known about what they hide. Therefore, the estimates of
                // hidden surfaces are those of the nearest row of the image.
                if (behind_ && width > 0 && picture_.y_begin < picture_.y_end)
                    behind_->row(std::clamp(y, picture_.y_begin, picture_.y_end - 1), behind_row);
                if (y >= picture_.y_begin && y < picture_.y_end) found[task].add(guessed(behind_row));
                for (int x = source.x_begin; x < source.x_end; ++x) {
                    std::optional<std::size_t> pixel;
                    std::span<const StackSample> stack;
                    if (picture_.stores(x, y)) {
                        pixel = picture_.pixel_at(x, y);
                        stack = picture_.stack(x, y);
                    } else if (!is_known(x, y)) {
                        pixel = border_->continued(x, y, continued);
                        if (!pixel) continue;
                        stack = continued;
                    }
                    const Behind* behind = pixel && behind_ ? &behind_row[*pixel % width] : nullptr;
                    const double open =
                        transmittance_behind(stack, pixel && picture_.is_nothing_behind(*pixel));
                    // Empty space may be visible behind a translucent surface.
                    if (behind != nullptr && picture_.stores(x, y) && ends_in_nothing(*behind, open))
                        found[task].is_see_through = true;
                    // The third argument tells whether the farthest sample of the pixel counts as opaque even
                    // if its alpha is below 1. This is so if there is no estimated surface behind it
                    // (`behind` is null), because nothing else could then fill the rest of the pixel.
                    lights.add(x, stack, behind == nullptr || behind->fills, open, behind, value, row);
                }
                splats.add_pixels(y, row);
            }
        });
        splats.finish();
        Guessed out;
        for (const Guessed& some : found) out.add(some);
        return out;
    }

    [[nodiscard]] bool is_known(int x, int y) const {
        return x >= corners_.x_begin && x < corners_.x_end - 1 && y >= corners_.y_begin &&
               y < corners_.y_end - 1;
    }
    /// Returns the pixels whose light the lens spreads over the image.
    [[nodiscard]] RasterWindow source_pixels() const {
        return border_ ? border_->window() : known_pixels(picture_);
    }

    Guessed spread(StackValue value, Image& image, FocusResult* report) const {
        const auto finish = [&](auto&& splats, const auto& method) {
            if constexpr (std::is_same_v<std::decay_t<decltype(splats)>, LayerSplats>) {
                splats.take_pixels(corners_);
            } else {
                // The method `scatter` divides the colour of each pixel by the sum of the weights of its
                // light. At the blurred edge of an object in front of empty space, this would make the edge
                // opaque. Therefore, empty space, which is black and transparent, fills the rest of the sum.
                splats.let_nothing_fill(nothing_);
            }
            const Guessed guessed = take_in(splats, value);
            method(splats, image, crop_);
            if (value == StackValue::alpha) undo_vignetting(splats.responses(), image);
            if (report == nullptr) return guessed;
            report->depths = levels_.depths().value_or(splats.levels_used());
            report->largest_coc_px = splats.largest_coc_px();
            if (auto warning = overscan_warning(splats.border(), corners_, window_, crop_))
                report->warnings.push_back(*std::move(warning));
            return guessed;
        };
        RasterWindow source = source_pixels();
        ++source.x_end;
        ++source.y_end;
        // The argument DepthModel::path has no effect here. A DepthModel states which depth determines the
        // blur of reflections and refractions: for example, that of the mirror or that of the image in it.
        // Images from other programs do not store reflections and refractions separately, so any value could
        // be passed.
        if (method_ == FocusMethod::layers) {
            return finish(LayerSplats(source, window_, geometry_, levels_, DepthModel::path, response_),
                          layers);
        }
        return finish(SplatTables(source, window_, geometry_, levels_, DepthModel::path, response_), scatter);
    }

    /// Removes the effect of vignetting from alpha. Towards the image's corners, vignetting decreases `open`,
    /// the fraction of the lens that sends light to a pixel. This should make pixels darker, but not
    /// translucent. Therefore, alpha is divided by `open`. A pixel without any light becomes opaque black.
    void undo_vignetting(const NodeResponses& responses, Image& alpha) const {
        for (int y = 0; y < alpha.height; ++y) {
            for (int x = 0; x < alpha.width; ++x) {
                const auto open = static_cast<float>(
                    responses.open_share(window_, window_.x_begin + x, window_.y_begin + y));
                float* value = alpha.pixel(x, y);
                for (int c = 0; c < 3; ++c) value[c] = open > 0 ? value[c] / open : 1;
            }
        }
    }

    const ForeignPicture& picture_;
    std::optional<Crop> crop_;
    FocusMethod method_;
    FocusGeometry geometry_;
    RasterWindow window_, corners_;
    DepthRange depths_;
    DepthLevels levels_;
    FocusGeometry reach_;  ///< around_aperture
    std::shared_ptr<const ResponseModel> response_;
    std::optional<BehindSearch> behind_;     ///< for `layers`
    std::optional<BorderExtension> border_;  ///< for `layers`
    std::vector<float> nothing_;             ///< nothing_in_reach, for `scatter`
};

/// Returns a grey image of the alpha of `of`.
Image grey(const Image& of) {
    Image out(of.width, of.height);
    for (std::size_t i = 0; i < out.rgb.size(); ++i) out.rgb[i] = of.alpha[i / 3];
    return out;
}
void take_alpha(const Image& grey, Image& image) {
    image.alpha.resize(grey.rgb.size() / 3);
    for (std::size_t i = 0; i < image.alpha.size(); ++i) image.alpha[i] = grey.rgb[3 * i];
}

/// Fills gaps of the image from the pixels around them. Gaps are pixels in which no lens point sees a
/// surface. Warns if a noticeable part of the light is missing. If the source image is opaque (`opaque`), the
/// filled image is opaque, too, so its alpha channel is removed.
void fill_unseen(StackField& field, const RasterWindow& drawn, bool opaque,
                 std::vector<FocusWarning>& warnings) {
    divide_by_covered(field);
    if (opaque) {
        field.image.alpha.clear();
    } else {
        Image alpha = grey(field.image);
        fill_gaps(alpha, field.covered);
        take_alpha(alpha, field.image);
    }
    fill_gaps(field.image, field.covered);
    double unseen = 0;
    for (const float share : field.unseen) unseen += static_cast<double>(share);
    const double share = unseen / (static_cast<double>(drawn.width()) * drawn.height());
    constexpr double noticeable = 1e-3;
    if (share > noticeable) {
        warnings.push_back(
            {"uncovered", share,
             fmt::format("{} % of the light comes from beyond the picture or from behind what it "
                         "shows: filled in from around",
                         rough(100 * share))});
    }
}

FocusResult by_field(const ForeignPicture& picture, const FocusSettings& settings,
                     const FocusGeometry& geometry, const RasterWindow& window,
                     const std::optional<Crop>& crop) {
    FocusResult out;
    out.method = FocusMethod::lightfield;
    out.views = settings.views;
    out.largest_coc_px = largest_coc_px(depth_range(picture), geometry);
    StackFieldSettings s{geometry, read_aperture(settings.impulse), window, window, settings.views};
    if (crop) {
        s.drawn = {window.x_begin + crop->x, window.x_begin + crop->x + crop->width, window.y_begin + crop->y,
                   window.y_begin + crop->y + crop->height};
    }
    const std::vector<Behind> behind =
        behind_fill(picture, around_aperture(geometry, s.aperture), s.aberration_px());
    StackField field = stack_field(picture, behind, s);
    Guessed of_picture = guessed(behind);
    for (std::size_t i = 0; i < behind.size() && !of_picture.is_see_through; ++i) {
        const double open = transmittance_behind(picture.stack_of(i), picture.is_nothing_behind(i));
        of_picture.is_see_through = ends_in_nothing(behind[i], open);
    }
    if (auto warning = guessed_warning(of_picture, picture)) out.warnings.push_back(*std::move(warning));
    // A hole is a pixel in which no lens point sees a surface. It is filled from the surrounding pixels, and
    // these may lie outside the crop, where nothing has been drawn. So if the crop contains a hole, the whole
    // image is drawn.
    const auto is_gap = [](float covered) { return !(covered > 0); };
    if (crop && std::any_of(field.covered.begin(), field.covered.end(), is_gap)) {
        s.drawn = window;
        field = stack_field(picture, behind, s);
    }
    fill_unseen(field, s.drawn, picture.is_opaque() && !of_picture.is_see_through, out.warnings);
    out.image = std::move(field.image);
    return out;
}

/// The pixels of a window of the image, without blur.
Image cut(const ForeignPicture& p, const RasterWindow& window) {
    if (window.x_begin == 0 && window.y_begin == 0 && window.width() == p.width &&
        window.height() == p.height)
        return p.flattened();
    ForeignPicture moved = p;
    moved.x_begin -= window.x_begin;
    moved.x_end -= window.x_begin;
    moved.y_begin -= window.y_begin;
    moved.y_end -= window.y_begin;
    moved.width = window.width();
    moved.height = window.height();
    return moved.flattened();
}

void reframe_all(Image& image, const RasterWindow& window, const ForeignPicture& p, double zoom) {
    Image alpha;
    if (!image.alpha.empty()) alpha = reframe(grey(image), window, p.width, p.height, zoom);
    image = reframe(image, window, p.width, p.height, zoom);
    take_alpha(alpha, image);
}

}  // namespace

Impulse impulse_in_px(const Impulse& impulse, double pixel_aspect) {
    Impulse out = impulse;
    out.squeeze *= pixel_aspect;
    if (pixel_aspect != 1 && (out.kind == ImpulseKind::diffraction || out.kind == ImpulseKind::lens)) {
        fail(ExitCode::wrong_arguments,
             "--impulse: needs square pixels (got {} and a pixelAspectRatio of {:g}; expected disc, polygon "
             "or "
             "image)",
             impulse_text(impulse), pixel_aspect);
    }
    return out;
}

FocusResult focus_foreign(const ForeignPicture& picture, const FocusSettings& asked) {
    FocusSettings settings = asked;
    const bool pinhole = settings.method == FocusMethod::pinhole || std::isinf(settings.lens.f_number);
    if (!pinhole) settings.impulse = impulse_in_px(asked.impulse, picture.pixel_aspect);
    const bool field = settings.method == FocusMethod::lightfield;
    if (!pinhole && !field && settings.method != FocusMethod::scatter &&
        settings.method != FocusMethod::layers) {
        fail(ExitCode::wrong_arguments,
             "--method: this one needs a sample file (got a picture of another program; expected pinhole, "
             "scatter, layers or lightfield)");
    }
    if (!pinhole && field) check_has_points(settings.impulse);
    check_crop(settings.crop, picture.width, picture.height);
    const Film film{picture.camera.film_distance_mm, picture.pixel_pitch_mm()};
    std::optional<LensView> view;
    if (!pinhole) view = real_lens(settings, film, {picture.width, picture.height}, known_corners(picture));
    FocusGeometry geometry =
        view ? view->geometry()
             : focus_geometry(settings.lens, settings.focus_distance_m, settings.framing, film);
    const Frame frame = framed(picture, settings.framing, geometry);
    // Images are blurred before they are magnified by `zoom`. So circles of confusion are computed in px of
    // the image before magnification.
    geometry.gain_px /= geometry.zoom;
    geometry.zoom = 1;
    FocusResult out;
    if (pinhole) {
        out.method = FocusMethod::pinhole;
        out.image = cut(picture, frame.window);
    } else if (field) {
        out = by_field(picture, settings, geometry, frame.window,
                       frame.zoom == 1 ? settings.crop : std::nullopt);
        out.largest_coc_px *= frame.zoom;
    } else {
        out = Spread(picture, settings, geometry, view ? &*view : nullptr, frame.window,
                     frame.zoom == 1 ? settings.crop : std::nullopt)
                  .picture();
        out.largest_coc_px *= frame.zoom;
    }
    if (frame.zoom != 1) reframe_all(out.image, frame.window, picture, frame.zoom);
    return out;
}

}  // namespace postlens
