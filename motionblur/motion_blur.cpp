#include "motionblur/motion_blur.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>
#include <utility>

#include "core/error.h"
#include "motionblur/field_blur.h"
#include "motionblur/groups/convolve_blur.h"
#include "motionblur/groups/depth_slices.h"
#include "motionblur/groups/slice_rule.h"
#include "motionblur/motion_warnings.h"
#include "motionblur/shutter_views.h"
#include "motionblur/still_pictures.h"
#include "pictures/crop.h"
#include "reproject/fill_gaps.h"

namespace postlens {
namespace {

void check(const MotionBlurSettings& s) {
    check_exposure(s.exposure);
    if (s.fit_px && !(*s.fit_px > 0 && std::isfinite(*s.fit_px))) {
        fail(ExitCode::wrong_arguments, "--fit-paths: out of range (got {}; expected px, more than 0)",
             *s.fit_px);
    }
    check_views(s.views);
}

/// Largest Crossing::most_mse with which the method `automatic` still uses convolution. This is the mean
/// squared error that convolution causes where two groups of moving objects pass over the same pixels. Up to
/// this value, the measured PSNR was at least 45 dB.
constexpr double most_crossing_mse = 1e-3;

class MotionBlur {
  public:
    MotionBlur(const SampleFileReader& file, const MotionBlurSettings& settings)
        : file_(file),
          header_(file.header()),
          settings_(settings),
          motion_(motion_of(header_, settings.paths)),
          bands_(file),
          extents_(file.instants()) {}

    MotionBlurResult run() {
        result_.image = file_.picture();
        if (!shows_frame_alone()) find_motion();
        choose();
        prepare_convolution();
        // Whether static pixels are averaged over time. If the file holds several recorded instants, shadows
        // and lights may differ between them, and this also changes the colours of static surfaces.
        const bool blends =
            file_.instants() > 1 && settings_.method != MotionMethod::convolve && !shows_frame_alone();
        const std::size_t pixels = result_.image.rgb.size() / 3;
        touched_.assign(pixels, 0);
        unknown_.assign(pixels, 0);
        if (!groups_.empty()) convolve_groups();
        const std::vector<std::uint32_t> convolved = ids_of(MotionMethod::convolve),
                                         reprojected = ids_of(MotionMethod::lightfield);
        if (!reprojected.empty() || blends) reproject(reprojected);
        result_.method = convolved.empty() == reprojected.empty()
                             ? (convolved.empty() ? settings_.method : MotionMethod::automatic)
                             : (convolved.empty() ? MotionMethod::lightfield : MotionMethod::convolve);
        warn(blends);
        return std::move(result_);
    }

  private:
    [[nodiscard]] bool shows_frame_alone() const {
        return settings_.exposure.open_s == header_.time_s && settings_.exposure.close_s == header_.time_s;
    }

    [[nodiscard]] std::vector<std::uint32_t> ids_of(MotionMethod method) const {
        std::vector<std::uint32_t> out;
        for (const ObjectReport& o : result_.objects) {
            if (o.method == method) out.push_back(o.id);
        }
        return out;
    }

    void find_motion() {
        const bool all = motion_.camera_moves(std::min(header_.time_s, settings_.exposure.open_s),
                                              std::max(header_.time_s, settings_.exposure.close_s));
        const std::vector<std::uint32_t> candidates = motion_.moving_ids();
        if (candidates.empty() && !all) return;
        const std::vector<std::uint32_t> only = all ? std::vector<std::uint32_t>() : candidates;
        bands_.read_all([&](const RecordBand& band) { return add_extents(band, only, extents_[0]); });
        std::map<std::uint32_t, IdMotion> found;
        for (const auto& [id, extent] : extents_[0])
            found[id] = classify(motion_, id, extent, header_.time_s, settings_.exposure);
        // Until here, `found` holds the kind of motion of each object that is recorded at the frame's
        // instant. At another recorded instant, an object may have another kind of motion, or it may be
        // recorded only there. Of several kinds, the most general is kept.
        for (std::size_t i = 1; i < file_.instants(); ++i) {
            RecordBands(file_, i).read_all([&](const RecordBand& band) {
                add_extents(band, only, extents_[i]);
                return false;
            });
            for (const auto& [id, extent] : extents_[i]) {
                const IdMotion m = classify(motion_, id, extent, file_.instant_s(i), settings_.exposure);
                auto [at, is_new] = found.emplace(id, m);
                if (is_new) {
                    if (m.kind != MotionKind::still) at->second.kind = MotionKind::general;
                    continue;
                }
                at->second.kind = std::max(at->second.kind, m.kind);
                at->second.largest_move_px = std::max(at->second.largest_move_px, m.largest_move_px);
                at->second.path_px = std::max(at->second.path_px, m.path_px);
                at->second.deviation_px = std::max(at->second.deviation_px, m.deviation_px);
            }
        }
        for (const auto& [id, m] : found) motions_.push_back(m);
    }

    void choose() {
        const bool relit = keys_show_other_light();
        for (const IdMotion& m : motions_) {
            ObjectReport o;
            o.id = m.id;
            o.name = name_of(header_, m.id);
            o.kind = m.kind;
            o.largest_move_px = m.largest_move_px;
            o.deviation_px = m.deviation_px;
            if (m.kind == MotionKind::still) {
                o.reason = fmt::format("stands still on the raster (moves {:.2g} px)", m.largest_move_px);
            } else if (settings_.method == MotionMethod::convolve && !extents_[0].contains(m.id)) {
                o.reason = "recorded at other instants only, which convolve does not use";
            } else if (settings_.method != MotionMethod::automatic) {
                o.method = settings_.method;
                o.reason = "asked for";
            } else if (m.kind != MotionKind::general && is_cut_at_frame(m.id)) {
                o.method = MotionMethod::lightfield;
                o.reason = fmt::format("moves {:.1f} px, and the border cuts it at the frame's instant",
                                       m.largest_move_px);
            } else if (m.kind == MotionKind::parallax && file_.instants() > 1) {
                o.method = MotionMethod::lightfield;
                o.reason = fmt::format(
                    "moves {:.1f} px, and the keys may show other sides of it than the frame's instant",
                    m.largest_move_px);
            } else if (m.kind != MotionKind::general && relit) {
                o.method = MotionMethod::lightfield;
                o.reason = fmt::format(
                    "moves {:.1f} px, and the keys may show other shading, shadows or "
                    "reflections than the frame's instant",
                    m.largest_move_px);
            } else if (m.kind == MotionKind::parallax) {
                o.method = MotionMethod::convolve;
                o.reason = "moves parallel to the film";  // prepare_convolution gives the details
            } else if (m.kind == MotionKind::translation) {
                o.method = MotionMethod::convolve;
                o.reason = fmt::format("moves as a whole, {:.1f} px, within {:.2f} px", m.largest_move_px,
                                       m.deviation_px);
            } else if (std::isinf(m.deviation_px)) {
                o.method = MotionMethod::lightfield;
                o.reason = "passes the camera";
            } else {
                o.method = MotionMethod::lightfield;
                o.reason = fmt::format("moves {:.1f} px, its parts differ by {:.1f} px", m.largest_move_px,
                                       m.deviation_px);
            }
            result_.objects.push_back(std::move(o));
        }
    }

    // Returns true if the border of the recorded image cuts off a part of the object that the motion may
    // bring into the image. Only the frame's instant is tested, because convolution uses no other recorded
    // instant.
    [[nodiscard]] bool is_cut_at_frame(std::uint32_t id) const {
        return is_cut(file_, motion_, id, std::span(extents_).first(1), settings_.exposure);
    }

    // Returns true if the method is `automatic`, and shadows, reflections or shading may differ between the
    // recorded instants. Moving objects are then blurred by the method lightfield, because convolution would
    // show the light of only one instant.
    [[nodiscard]] bool keys_show_other_light() const {
        return file_.instants() > 1 && settings_.method == MotionMethod::automatic &&
               UnseenMotion(header_, with_unseen(moving_ids(motions_)), settings_.exposure).possible();
    }

    // Pixel rows over which moving objects pass.
    [[nodiscard]] std::pair<int, int> rows_touched() const {
        double low = header_.height, high = 0;
        for (const MovingGroup& g : groups_) {
            const PassedBox box = passed_box(g);
            low = std::min(low, box.low_px.y);
            high = std::max(high, box.high_px.y);
        }
        const auto within = [&](double y) {
            return static_cast<int>(
                std::clamp(y, static_cast<double>(file_.y_begin()), static_cast<double>(file_.y_end())));
        };
        // A margin of 2 rows above and below allows for the width of a sample and the rounding of the motion
        // path.
        return {within(std::floor(low) - 2), within(std::ceil(high) + 2)};
    }

    void prepare_convolution() {
        std::vector<IdMotion> ids;
        for (std::size_t i = 0; i < motions_.size(); ++i) {
            if (result_.objects[i].method == MotionMethod::convolve) ids.push_back(motions_[i]);
        }
        if (ids.empty()) return;
        groups_ =
            find_groups(motion_, ids, extents_[0], header_.time_s, settings_.exposure, settings_.fit_px);
        const auto [y_begin, y_end] = rows_touched();
        bands_.need(y_begin, y_end);
        surfaces_ = band_surfaces(bands_.bands(), y_begin, y_end);
        if (settings_.method == MotionMethod::automatic) leave_to_lightfield();
        for (const MovingGroup& g : groups_) {
            for_objects(g, [&](ObjectReport& o) {
                o.slices = g.has_parallax ? slices_for(g) : 1;
                o.path_points = g.points;
                o.fitted_knots = g.fitted_knots;
                o.fit_error_px = g.fit_error_px;
                if (!g.has_parallax || settings_.method != MotionMethod::automatic) return;
                o.reason = fmt::format(
                    "moves parallel to the film, {:.1f} px, its nearest and farthest parts {:.2g} px apart: "
                    "{} slices of depth",
                    o.largest_move_px, parallax_px(g), o.slices);
            });
        }
    }

    template <typename OnObject>
    void for_objects(const MovingGroup& g, const OnObject& on_object) {
        for (ObjectReport& o : result_.objects) {
            if (std::binary_search(g.ids.begin(), g.ids.end(), o.id)) on_object(o);
        }
    }

    void leave_to_lightfield() {
        const GroupTable table(groups_);
        std::vector<MovingGroup> kept;
        for (std::size_t i = 0; i < groups_.size(); ++i) {
            const MovingGroup& g = groups_[i];
            const std::string why =
                g.has_parallax ? why_not_sliced(groups_, i, table, surfaces_, header_) : "";
            if (why.empty()) {
                kept.push_back(g);
            } else {
                leave_to_lightfield(g, why);
            }
        }
        groups_ = std::move(kept);
    }

    void leave_to_lightfield(const MovingGroup& g, const std::string& why) {
        for_objects(g, [&](ObjectReport& o) {
            o.method = MotionMethod::lightfield;
            o.slices = 0;
            o.path_points = o.fitted_knots = 0;
            o.reason = fmt::format("moves parallel to the film, {:.1f} px, but {}", o.largest_move_px, why);
        });
    }

    /// Blurs groups by convolution. A group consists of the moving objects that have the same motion path.
    /// With the method `automatic`, a group is left to the method `lightfield` if another moving group passes
    /// over the same pixels and the error of convolution would be large.
    void convolve_groups() {
        ConvolveBlur blur = convolve_blur(result_.image, surfaces_, groups_, settings_.exposure,
                                          settings_.curve, across_per_px(header_));
        result_.image = std::move(blur.image);
        touched_ = std::move(blur.touched);
        unknown_ = std::move(blur.unknown);
        if (settings_.method != MotionMethod::automatic) return;
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const Crossing& at = blur.crossings[g];
            if (at.most_mse <= most_crossing_mse) continue;
            leave_to_lightfield(
                groups_[g], label_of(header_, groups_[at.other].ids.front()) + " moves over the same pixels");
        }
    }

    void reproject(const std::vector<std::uint32_t>& wanted) {
        const std::vector<SheetMesh> sheets = blur_sheets(file_);
        FieldBlurSettings by_field{.exposure = settings_.exposure,
                                   .curve = settings_.curve,
                                   .views = settings_.views,
                                   .crop = settings_.crop};
        FieldBlur blur = field_blur(header_, sheets, motion_, motions_, wanted, by_field);
        const auto has_gaps = [&] {
            const std::vector<float>& u = blur.picture.unknown;
            return std::any_of(u.begin(), u.end(), [](float share) { return share > 0; });
        };
        std::vector<std::uint8_t> covered;
        if (has_gaps()) covered = pixels_showing(header_, bands_.bands(), moving_ids(motions_));
        if (by_field.crop && !covered.empty() && all_of(covered)) {
            // An unrecorded background behind moving objects is interpolated from pixels that show static
            // surfaces. If there are none, it is interpolated from the blurred image. Then the whole image is
            // blurred, because the result must not depend on the crop.
            by_field.crop.reset();
            blur = field_blur(header_, sheets, motion_, motions_, wanted, by_field);
        }
        result_.views = blur.views;
        if (sheets.size() > 1)
            blend_stills(file_, blur.instant_shares, ids_of(MotionMethod::convolve), touched_, result_.image);
        Image filled;  // colours for the unknown shares of the pixels
        const PatchPicture& p = blur.picture;
        if (!covered.empty()) filled = fill_behind(p, covered);
        lay_over(result_.image, p, wanted_mark, filled);
        for (std::size_t k = 0; k < p.touched.size(); ++k) {
            if ((p.touched[k] & wanted_mark) == 0) continue;
            touched_[k] = 1;
            unknown_[k] = p.unknown[k];
        }
    }

    static bool all_of(const std::vector<std::uint8_t>& marks) {
        return std::find(marks.begin(), marks.end(), 0) == marks.end();
    }

    // Returns an image of the background behind moving objects. It is interpolated from the pixels that show
    // static surfaces. `covered` marks the other pixels, in which a moving object is recorded.
    [[nodiscard]] Image fill_behind(const PatchPicture& p, const std::vector<std::uint8_t>& covered) const {
        // If a moving object is recorded in every pixel, the background is interpolated from the blurred
        // image `p`: from those pixels that show a surface for at least a part of the exposure.
        const bool all = all_of(covered);
        Image out = all ? p.image : file_.picture();
        std::vector<float> weight(covered.size());
        for (std::size_t k = 0; k < weight.size(); ++k)
            weight[k] = all ? (p.unknown[k] < 1 ? 1.0F : 0.0F) : covered[k] != 0 ? 0.0F : 1.0F;
        fill_gaps(out, weight);
        return out;
    }

    void warn(bool blends) {
        const std::vector<std::uint8_t> touched = cut(touched_, header_.width, settings_.crop);
        result_.touched_share = static_cast<double>(std::count(touched.begin(), touched.end(), 1)) /
                                static_cast<double>(touched.size());
        warn_of_gaps(cut(unknown_, header_.width, settings_.crop),
                     "what moving objects uncover was not recorded in {:.2f} % of the pixels and is filled "
                     "from around them (expected `trace --for-shutter`, more `--keys`, or `--overscan` at "
                     "the frame's edge)",
                     result_.warnings);
        const std::vector<std::uint32_t> moving = moving_ids(motions_);
        warn_of_cut(file_, motion_, result_.objects, extents_, settings_.exposure, result_.warnings);
        warn_of_left_out();
        if (blends) return;
        UnseenMotion unseen(header_, with_unseen(moving), settings_.exposure);
        if (!unseen.possible()) return;
        bands_.need_all();
        for (const RecordBand& band : bands_.bands()) {
            // The band's last row is also the next band's first row.
            unseen.add(band, band.y_begin, band.y_end - 1);
        }
        for (MotionWarning& warning : unseen.warnings()) result_.warnings.push_back(std::move(warning));
    }

    // Adds objects to `moving`, a list of the ids of moving objects. `motions_` contains only objects that
    // are recorded directly in some pixel. Other objects may move, too, and be visible only in mirrors or
    // glass. Their motion is in the file's header.
    [[nodiscard]] std::vector<std::uint32_t> with_unseen(std::vector<std::uint32_t> moving) const {
        const double first_s = std::min(settings_.exposure.open_s, header_.time_s),
                     last_s = std::max(settings_.exposure.close_s, header_.time_s);
        for (const auto& [id, motion] : header_.motion.objects) {
            const auto is_it = [id = id](const IdMotion& m) { return m.id == id; };
            if (std::none_of(motions_.begin(), motions_.end(), is_it) &&
                MotionPath(motion.keys).moves(first_s, last_s))
                moving.push_back(id);
        }
        std::sort(moving.begin(), moving.end());
        return moving;
    }

    // Warns of moving objects that cannot be blurred by the method `convolve`. It moves an object's image at
    // the frame's instant, and at this instant, these objects are not visible.
    void warn_of_left_out() {
        std::string names;
        for (const ObjectReport& o : result_.objects) {
            if (o.kind == MotionKind::still || o.method != MotionMethod::automatic) continue;
            names += (names.empty() ? "" : ", ") + label_of(header_, o.id);
        }
        if (names.empty()) return;
        result_.warnings.push_back(
            {"left_out", 0,
             fmt::format("moving objects are recorded at other instants than the frame's only, and left out: "
                         "{} (expected --method lightfield or auto)",
                         names)});
    }

    const SampleFileReader& file_;
    const SampleHeader& header_;
    const MotionBlurSettings& settings_;
    FrameMotion motion_;
    RecordBands bands_;
    std::vector<IdExtents> extents_;      ///< bounding boxes of the objects at every recorded instant
    std::vector<MovingGroup> groups_;     ///< groups of objects to blur by convolution
    std::vector<BandSurfaces> surfaces_;  ///< surfaces in the pixel rows over which these groups pass
    std::vector<IdMotion> motions_;       ///< sorted by id, as result_.objects
    std::vector<std::uint8_t> touched_;
    std::vector<float> unknown_;
    MotionBlurResult result_;
};

}  // namespace

void check_exposure(const Exposure& e) {
    if (!(e.open_s <= e.close_s)) {
        fail(ExitCode::wrong_arguments,
             "--shutter: closes before it opens (got {}:{}; expected finite seconds, OPEN not after CLOSE)",
             e.open_s, e.close_s);
    }
    // The difference is not finite if a time is infinite, or if the subtraction overflows.
    if (!std::isfinite(e.close_s - e.open_s)) {
        fail(ExitCode::wrong_arguments, "--shutter: too long (got {}:{}; expected finite seconds)", e.open_s,
             e.close_s);
    }
}

MotionBlurResult motion_blur(const SampleFileReader& file, const MotionBlurSettings& settings) {
    check(settings);
    check_crop(settings.crop, file.header().width, file.header().height);
    MotionBlurResult out = MotionBlur(file, settings).run();
    out.image.exposure_stops = file.exposure_stops();
    return out;
}

}  // namespace postlens
