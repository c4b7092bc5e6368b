#include "focus/focus.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/memory.h"
#include "core/text.h"
#include "core/threads.h"
#include "focus/layers/layers.h"
#include "focus/lens_model.h"
#include "focus/light_field/field_focus.h"
#include "focus/overscan.h"
#include "focus/reframe.h"
#include "focus/scatter/scatter.h"
#include "focus/scatter/splat_tables.h"
#include "pictures/aperture_file.h"
#include "pictures/crop.h"
#include "records/quadtree.h"

namespace postlens {
namespace {

/// The rectangle of traced pixels that the result shows, and how much it is magnified.
struct View {
    RasterWindow window;
    double zoom = 1;
};

View framed(const SampleFileReader& file, const FocusSettings& settings, const FocusGeometry& geometry) {
    const SampleHeader& h = file.header();
    View out{{0, h.width, 0, h.height}, 1};
    if (settings.framing == Framing::keep) return out;
    out = {window_for_zoom(h.width, h.height, geometry.zoom), geometry.zoom};
    const RasterWindow& w = out.window;
    if (w.x_begin < file.x_begin() || w.y_begin < file.y_begin() || w.x_end > file.x_end() - 1 ||
        w.y_end > file.y_end() - 1) {
        const double widest = std::max(static_cast<double>(h.width) / (h.width + 2.0 * h.overscan_px),
                                       static_cast<double>(h.height) / (h.height + 2.0 * h.overscan_px));
        fail(ExitCode::wrong_arguments,
             "the sample file's field of view is too narrow for this framing (got a film at {:.6g} mm; "
             "expected {:.6g} "
             "mm or more, or the framing of the trace kept)",
             geometry.zoom * h.film_distance_mm, widest * h.film_distance_mm);
    }
    return out;
}

Image traced_picture(FocusFrame& frame, const RasterWindow& window, const std::optional<Crop>& crop) {
    Image image(window.width(), window.height());
    image.exposure_stops = frame.file().exposure_stops();
    const Crop part = crop.value_or(Crop{0, 0, window.width(), window.height()});
    const int first = window.y_begin + part.y, last = first + part.height, left = window.x_begin + part.x;
    frame.visit_rows(first, last, [&](const FrameRows& rows) {
        const int begin = std::max(rows.y_begin, first), end = std::min(rows.y_end, last);
        parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
            const int y = begin + static_cast<int>(i);
            picture_row(*rows.band, y, left, left + part.width,
                        {image.pixel(part.x, y - window.y_begin), static_cast<std::size_t>(part.width) * 3});
        });
    });
    return image;
}

/// Passes the surface samples (records) of all rows to `splats`, which collects them to be blurred.
template <typename Splats>
void take_in(FocusFrame& frame, Splats& splats) {
    frame.visit_rows(frame.file().y_begin(), frame.file().y_end(),
                     [&](const FrameRows& rows) { splats.add_rows(rows); });
    splats.finish();
}

/// Limits the memory for blurred samples (splats). An image that needs more is computed in groups of rows
/// (strips).
struct StripPlan {
    double splats_per_record;
    std::size_t bytes_of_splat;
    std::size_t most_bytes;  ///< memory limit for the splats of one strip
    int block_px;            ///< edge of the pixel blocks that are scattered together
};

/// Computes an image in groups of rows (strips), to save memory. draw(part) computes one strip. The image is
/// bit-identical to one that is computed at once.
template <typename Splats, typename Draw>
void in_strips(FocusFrame& frame, Splats& splats, const StripPlan& plan, const std::optional<Crop>& crop,
               const Draw& draw) {
    const int block_px = plan.block_px;
    const std::size_t most_bytes = plan.most_bytes;
    splats.survey();
    take_in(frame, splats);
    const auto add = [&](const RasterWindow& part) {
        give_back_memory();
        for (const auto& [first, last] : splats.begin_strip(part, block_px))
            frame.visit_rows(first, last, [&](const FrameRows& rows) { splats.add_rows(rows); });
        splats.finish_strip();
    };
    add({});
    const RasterWindow& picture = splats.picture();
    const Crop all{0, 0, picture.width(), picture.height()}, wanted = crop.value_or(all);
    const auto draw_part = [&](int x, int x_end, int y, int y_end) {
        if (!wanted.meets(x, y, x_end - x, y_end - y)) return;
        add({picture.x_begin + x, picture.x_begin + x_end, picture.y_begin + y, picture.y_begin + y_end});
        const int left = std::max(x, wanted.x), top = std::max(y, wanted.y);
        draw(Crop{left, top, std::min(x_end, wanted.x + wanted.width) - left,
                  std::min(y_end, wanted.y + wanted.height) - top});
    };
    const int rows = (picture.height() + block_px - 1) / block_px,
              columns = (picture.width() + block_px - 1) / block_px;
    const auto bytes = [&](int begin, int end) {
        return splats.splats_reaching(begin, end) * plan.bytes_of_splat;
    };
    for (int row = 0, end = 0; row < rows; row = end) {
        end = row + 1;
        while (end < rows && bytes(row, end + 1) <= most_bytes) ++end;
        const int y = row * block_px, y_end = std::min(end * block_px, picture.height());
        // The image is divided into square blocks, and as many rows of blocks are drawn at once as fit into
        // `most_bytes` of memory. Even a single row of blocks may need more memory. It is then divided into
        // parts, which are drawn one after another from left to right.
        const auto parts = static_cast<int>(std::min<std::uint64_t>(
            bytes(row, end) / std::max<std::size_t>(most_bytes, 1) + 1, static_cast<std::uint64_t>(columns)));
        const int width = (columns + parts - 1) / parts * block_px;
        for (int x = 0; x < picture.width(); x += width)
            draw_part(x, std::min(x + width, picture.width()), y, y_end);
    }
}

/// Returns the lens geometry with all lengths on the film in px of the traced image instead of px of the
/// final image. Images are blurred first and magnified by `zoom` afterwards, so blurring needs the px of the
/// traced image.
FocusGeometry in_traced_px(FocusGeometry geometry) {
    geometry.gain_px /= geometry.zoom;
    geometry.zoom = 1;
    return geometry;
}

FocusResult spread(FocusFrame& frame, const FocusSettings& settings, const FocusGeometry& geometry,
                   const LensView* view, const RasterWindow& window, const std::optional<Crop>& crop) {
    const SampleFileReader& file = frame.file();
    const FocusGeometry traced = in_traced_px(geometry);
    const DepthRange range = depth_range(file);
    const DepthLevels levels(traced, range, settings.spacing, settings.depths);
    const RasterWindow corners = recorded_corners(file);
    const std::shared_ptr<const ResponseModel> response =
        view != nullptr
            ? lens_model(*view, traced, std::hypot(corners.width(), corners.height()) / 2.0,
                         1 / range.nearest_m.value_or(std::numeric_limits<double>::infinity()))
            : response_model(settings.impulse, traced, std::hypot(window.width(), window.height()) / 2.0);
    FocusResult out;
    out.method = settings.method;
    bool parts = false;
    const auto spread_all = [&](auto&& splats, const StripPlan& plan, const auto& method) {
        const auto draw = [&](const std::optional<Crop>& part) { method(splats, out.image, part); };
        if (static_cast<double>(file.record_count()) * plan.splats_per_record *
                static_cast<double>(plan.bytes_of_splat) >
            static_cast<double>(settings.splat_bytes)) {
            in_strips(frame, splats, plan, crop, draw);
            parts = true;
        } else {
            take_in(frame, splats);
            draw(crop);
        }
        out.depths = levels.depths().value_or(splats.levels_used());
        out.largest_coc_px = splats.largest_coc_px() * geometry.zoom;
        if (auto warning = overscan_warning(splats.border(), corners, window, crop))
            out.warnings.push_back(*std::move(warning));
    };
    if (settings.method == FocusMethod::layers) {
        // The method layers stores the samples (surface points with their circles of confusion) in a table
        // before it blurs them. This table may fill a sixth of the memory limit, `splat_bytes`. The rest is
        // needed to sort the samples and to composite the layers.
        spread_all(LayerSplats(corners, window, traced, levels, settings.depth_model, response),
                   {1, sizeof(LayerSplat), settings.splat_bytes / 6, layers_block_px},
                   [](const LayerSplats& splats, Image& image, const std::optional<Crop>& part) {
                       layers(splats, image, part);
                   });
    } else {
        // The method scatter stores the samples (surface points with their circles of confusion) in tables
        // before it blurs them. These tables may fill a third of the memory limit. The rest is for the blur
        // kernels and the colours of the image.
        spread_all(SplatTables(corners, window, traced, levels, settings.depth_model, response),
                   {4, sizeof(Splat), settings.splat_bytes / 3, scatter_block_px},
                   [](const SplatTables& splats, Image& image, const std::optional<Crop>& part) {
                       scatter(splats, image, part);
                   });
    }
    // Frees unused memory first, because writing the image file needs as much memory as the image itself.
    if (parts) give_back_memory();
    return out;
}

FocusResult seen_from_lens(FocusFrame& frame, const FocusSettings& settings, const FocusGeometry& geometry,
                           const RasterWindow& window, const std::optional<Crop>& crop) {
    check_has_points(settings.impulse);
    if (settings.depth_model != DepthModel::ray_differentials) {
        fail(ExitCode::wrong_arguments,
             "--depth-model: lightfield knows what is seen in mirrors by W (expected W, or another method)");
    }
    FieldFocusSettings by_field{
        in_traced_px(geometry), read_aperture(settings.impulse), window, settings.views, {}, {}, {}, crop};
    FieldFocus seen = field_focus(frame, by_field);
    const double unknown_share = mean_of(seen.unknown, window.width(), crop);
    const std::vector<float> unknown_below = cut(seen.unknown_below, window.width(), crop);
    FocusResult out;
    out.method = FocusMethod::lightfield;
    out.image = std::move(seen.image);
    out.views = settings.views;
    out.largest_coc_px = largest_coc_px(depth_range(frame.file()), geometry);
    const auto response = aperture_model(by_field.aperture, by_field.geometry,
                                         std::hypot(window.width(), window.height()) / 2.0);
    if (auto warning = overscan_warning(frame.border_depths().radii(by_field.geometry, *response),
                                        recorded_corners(frame.file()), window, crop))
        out.warnings.push_back(*std::move(warning));
    constexpr double noticeable = 1e-3;
    if (unknown_share > noticeable) {
        out.warnings.push_back({"uncovered", unknown_share,
                                fmt::format("{} % of the light comes from what was never recorded "
                                            "(trace with --hidden-layers and --overscan auto for this lens)",
                                            rough(100 * unknown_share))});
    }
    // The second warning counts pixels in mirrors or glass for which the sample file lacks a reflection or
    // refraction that some lens points see. A pixel counts if the missing light is more than this share of
    // the pixel's light.
    constexpr float visible = 0.02F;
    const double below = static_cast<double>(std::count_if(unknown_below.begin(), unknown_below.end(),
                                                           [](float u) { return u > visible; })) /
                         static_cast<double>(std::max<std::size_t>(unknown_below.size(), 1));
    if (below > noticeable) {
        out.warnings.push_back(
            {"uncovered", below,
             fmt::format("{} % of the pixels show in mirrors or glass what was never recorded (expected "
                         "--method hybrid with --scene, which traces them again)",
                         rough(100 * below))});
    }
    return out;
}

}  // namespace

FocusResult focus_picture(FocusFrame& frame, const FocusSettings& settings) {
    const SampleFileReader& file = frame.file();
    const SampleHeader& h = file.header();
    const bool pinhole = settings.method == FocusMethod::pinhole || std::isinf(settings.lens.f_number);
    check_crop(settings.crop, h.width, h.height);
    if (h.projection == Projection::orthographic) {
        if (!pinhole) {
            fail(ExitCode::wrong_arguments,
                 "f-number is out of range for an orthographic file, which no lens can have taken (got {}; "
                 "expected "
                 "infinity)",
                 settings.lens.f_number);
        }
        if (settings.framing != Framing::keep) {
            fail(ExitCode::wrong_arguments,
                 "framing is out of range for an orthographic file, which has no film distance (got another "
                 "film "
                 "distance; expected the framing of the trace kept)");
        }
        return {.image = traced_picture(frame, {0, h.width, 0, h.height}, settings.crop),
                .method = FocusMethod::pinhole,
                .geometry = {},
                .warnings = {}};
    }
    const Film film{h.film_distance_mm, h.pixel_pitch_mm};
    std::optional<LensView> view;
    if (!pinhole) view = real_lens(settings, film, {h.width, h.height}, recorded_corners(file));
    const FocusGeometry geometry =
        view ? view->geometry()
             : focus_geometry(settings.lens, settings.focus_distance_m, settings.framing, film);
    const View shown = framed(file, settings, geometry);
    // `settings.crop` is in pixels of the final image. If the lens magnifies (zoom != 1), the image is
    // blurred first and magnified afterwards. The blurred image then has other pixels than the final one, so
    // the whole image is blurred.
    const std::optional<Crop> crop = shown.zoom == 1 ? settings.crop : std::nullopt;
    FocusResult out;
    if (pinhole) {
        out.method = FocusMethod::pinhole;
        out.image = traced_picture(frame, shown.window, crop);
    } else if (settings.method == FocusMethod::lightfield) {
        out = seen_from_lens(frame, settings, geometry, shown.window, crop);
    } else {
        out = spread(frame, settings, geometry, view ? &*view : nullptr, shown.window, crop);
    }
    if (shown.zoom != 1) out.image = reframe(out.image, shown.window, h.width, h.height, shown.zoom);
    out.geometry = geometry;
    out.image.exposure_stops = file.exposure_stops();
    return out;
}

FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings) {
    FocusFrame frame(file);
    return focus_picture(frame, settings);
}

Image pinhole_picture(const SampleFileReader& file, const std::optional<Crop>& crop) {
    const SampleHeader& h = file.header();
    check_crop(crop, h.width, h.height);
    FocusFrame frame(file);
    return traced_picture(frame, {0, h.width, 0, h.height}, crop);
}

}  // namespace postlens
