#include "sweep/sweep.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <future>
#include <map>
#include <optional>
#include <set>

#include "core/checksum.h"
#include "core/error.h"
#include "core/files/file_identity.h"
#include "core/files/folder.h"
#include "core/files/output_file.h"
#include "core/files/share_table.h"
#include "core/progress.h"
#include "core/threads.h"
#include "focus/bend_warning.h"
#include "pictures/exposure.h"
#include "records/pixel_samples.h"
#include "sweep/contact_sheet.h"
#include "sweep/earlier_run.h"
#include "sweep/figures.h"
#include "sweep/sweep_checks.h"

namespace postlens {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    OutputFile out(path);
    out.write(text);
    out.commit();
}

/// A running sweep.
class Sweep {
  public:
    Sweep(const std::filesystem::path& frame, const SweepSettings& settings,
          const std::filesystem::path& folder)
        : settings_(settings),
          folder_(folder),
          file_(frame, settings.damage, settings.exposure_stops),
          grid_(sweep_grid(settings.axes)),
          names_(sweep_file_names(settings, grid_)),
          rows_(names_.size()),
          maker_(file_, settings.picture, !settings.axes.shutters.empty()) {
        check_sweep_limits(settings);
        out_.table.frame = frame.string();
        out_.table.coc_limit_px = settings.coc_limit_px;
        out_.table.part = settings.part;
        out_.table.at = sweep_points(settings, file_.header());
        out_.csv = folder / "sweep.csv";
        out_.json = folder / "sweep.json";
        if (settings.share) out_.json = folder / share_table_name("sweep", *settings.share);
        check_sweep_lenses(settings, grid_, file_.header(), maker_.method());
        check_outputs(frame);
        make_folder(folder);
        keys_.emplace(frame, settings, file_.exposure_stops(), maker_.method(), out_.table.at);
    }

    SweepResult run() {
        const SampleHeader& h = file_.header();
        std::optional<ContactSheet> sheet;
        if (grid_.pictures.size() <= ContactSheet::most_pictures && !settings_.share) {
            std::vector<std::string> captions;
            for (const SweepSetting& s : grid_.pictures) captions.push_back(s.caption);
            sheet.emplace(ImageSize{h.width, h.height}, std::move(captions), grid_.row);
        }
        std::future<std::string> drawn;  // declared after `sheet`, which it reads
        Progress progress("sweep", pictures_to_make());
        try {
            // Images of an earlier run are kept before new images are made. Then sweep.json lists the kept
            // images even if this run is interrupted while it makes the others.
            keep_what_is_there(sheet ? &*sheet : nullptr, progress);
            if (settings_.join == Join::no) make_the_others(sheet ? &*sheet : nullptr, progress);
            if (settings_.join != Join::no) check_complete();
            // Encodes the contact sheet while the last images are being written.
            if (sheet) {
                drawn = std::async(std::launch::async, [&sheet] {
                    const ThreadLimit one(1);
                    return png_file(sheet->picture(), "contact.png");
                });
            }
            while (!finishing_.empty()) finish(progress);
        } catch (...) {
            save_if_possible();
            throw;
        }
        save();
        if (!settings_.share) write_text(out_.csv, csv_text(out_.table));
        if (sheet) {
            out_.contact_sheet = folder_ / "contact.png";
            write_file(*out_.contact_sheet, drawn.get());
        }
        return std::move(out_);
    }

  private:
    /// Throws if an output file would overwrite an input file.
    void check_outputs(const std::filesystem::path& frame) const {
        std::vector<std::filesystem::path> written{out_.csv, out_.json, folder_ / "contact.png"};
        for (const std::string& name : names_) written.push_back(folder_ / name);
        refuse_overwriting(sweep_inputs(frame, settings_), written);
    }

    [[nodiscard]] bool is_mine(std::size_t i) const { return !settings_.share || settings_.share->has(i); }
    [[nodiscard]] std::size_t pictures_to_make() const {
        std::size_t count = 0;
        for (std::size_t i = 0; i < names_.size(); ++i) count += is_mine(i) ? 1 : 0;
        return count;
    }

    /// Returns whether the image number i of an earlier run can be kept, because it was made with equal
    /// settings and its file has not changed. If so, its table row is copied, and the image is read into
    /// `image`, unless `image` is null.
    bool keep(std::size_t i, const std::multimap<std::string, SweepRow>& earlier, Image* image) {
        const auto [begin, end] = earlier.equal_range(name_in_json(names_[i]));
        if (begin == end) return false;
        const SweepSetting& s = grid_.pictures[i];
        const std::filesystem::path path = folder_ / names_[i];
        const std::string checksum = file_checksum_text(path);
        const auto found = std::find_if(begin, end, [&](const auto& named) {
            const SweepRow& row = named.second;
            return keys_->fits(row.settings_key, s) && !checksum.empty() &&
                   row.picture_checksum == checksum && row.coc_px.size() == out_.table.at.size();
        });
        if (found == end) return false;
        if (image != nullptr) *image = read_image(path);
        SweepRow row = found->second;
        row.setting = s;
        row.file = names_[i];
        rows_[i] = std::move(row);
        ++out_.kept;
        return true;
    }

    void keep_what_is_there(ContactSheet* sheet, Progress& progress) {
        const std::multimap<std::string, SweepRow> earlier = earlier_rows(settings_, folder_, out_.json);
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (!is_mine(i)) continue;
            throw_if_interrupted();
            Image image;
            if (!keep(i, earlier, sheet != nullptr ? &image : nullptr)) continue;
            if (sheet != nullptr) sheet->set(i, image);
            progress.advance();
        }
    }

    void check_complete() {
        std::vector<std::string>& missing = out_.missing;
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (!rows_[i]) missing.push_back(names_[i]);
        if (missing.empty() || settings_.join == Join::partial) return;
        fail(ExitCode::invalid_input,
             "{}: {} of {} pictures are missing or not as their table says, e.g. {} (expected all; --partial "
             "joins what is there)",
             folder_.string(), missing.size(), rows_.size(), missing.front());
    }

    struct Making {
        MadePicture picture;
        double seconds = 0;
    };

    void make_the_others(ContactSheet* sheet, Progress& progress) {
        std::vector<std::size_t> wanted;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (!rows_[i] && is_mine(i)) wanted.push_back(i);
        }
        if (wanted.empty()) return;
        prepare();
        const auto make = [&](std::size_t k) {
            const auto start = Clock::now();
            Making out{maker_.make(grid_.pictures[wanted[k]]), 0};
            out.seconds = seconds_since(start);
            return out;
        };
        make_in_order(wanted.size(), at_a_time(), make, [&](std::size_t k, Making&& m) {
            warn_of_bend(m.picture);
            std::set<std::string> codes;  // a picture with two warnings of one code counts once
            for (const FocusWarning& w : m.picture.warnings) note(w, codes.insert(w.code).second ? 1 : 0);
            if (settings_.format != "exr") {
                if (const auto w = exposure_warning(m.picture.image, std::nullopt))
                    note({"exposure", w->share, w->text});
            }
            if (sheet != nullptr) sheet->set(wanted[k], m.picture.image);
            while (finishing_.size() >= most_finishing(m.picture.image)) finish(progress);
            const double energy = pinhole_energy_for(m.picture);
            start_finishing(wanted[k], std::move(m), energy);
            if (seconds_since(saved_) > 1) save();
        });
    }

    /// Returns the number of images that are made at the same time. It is 2 for methods that only read the
    /// records of a small sample file, because a single image does not keep all threads busy. Otherwise, it
    /// is 1.
    [[nodiscard]] std::size_t at_a_time() const {
        constexpr std::uint64_t most_records = 2'000'000;
        return by_records() && !settings_.picture.predict && file_.record_count() <= most_records ? 2 : 1;
    }

    [[nodiscard]] bool by_records() const {
        return maker_.method() == FocusMethod::scatter || maker_.method() == FocusMethod::layers ||
               maker_.method() == FocusMethod::pinhole;
    }

    /// Returns the number of images that may be written to files at the same time, 1 to 4. The images that
    /// wait to be written are kept in memory. Together, they take at most 64 MiB, unless a single image is
    /// larger.
    [[nodiscard]] static std::size_t most_finishing(const Image& image) {
        constexpr std::size_t most = 4, bytes_together = std::size_t{64} << 20;
        return std::clamp<std::size_t>(bytes_together / (image.rgb.size() * sizeof(float) + 1), 1, most);
    }

    /// Starts a background thread that writes the image number i to its file and computes its row in the
    /// table of results. If the user cancels the sweep, the thread still completes its work, so that no
    /// finished image is lost.
    void start_finishing(std::size_t i, Making made, double pinhole_energy) {
        finishing_.push_back(
            {i, std::async(std::launch::async, [this, i, pinhole_energy, made = std::move(made)] {
                 const ThreadLimit one(1);
                 const auto start = Clock::now();
                 SweepRow row = finished_row(i, made.picture, pinhole_energy);
                 row.seconds = made.seconds + seconds_since(start);
                 return row;
             })});
    }

    /// Waits until the oldest of the images in progress is written.
    void finish() {
        Finishing first = std::move(finishing_.front());
        finishing_.pop_front();
        rows_[first.picture] = first.row.get();
        ++out_.made;
    }
    void finish(Progress& progress) {
        finish();
        progress.advance();
    }

    [[nodiscard]] SweepRow finished_row(std::size_t i, const MadePicture& made, double pinhole_energy) const {
        const SweepSetting& s = grid_.pictures[i];
        const std::filesystem::path path = folder_ / names_[i];
        const std::uint64_t checksum = write_image(path, made.image);
        SweepRow row{.setting = s, .file = names_[i], .method = made.method};
        row.depths = made.depths;
        row.views = made.views;
        row.predicted_db = made.predicted_db;
        const auto coc_px = [&](double inverse_z) {
            return made.geometry ? made.geometry->coc_diameter_px(inverse_z) : 0.0;
        };
        // A pinhole's CoC diameter is 0, but in front of the focus its sign is negative. Adding 0 turns -0
        // into 0.
        for (const double inverse_z : inverse_z_at_) row.coc_px.push_back(coc_px(inverse_z) + 0.0);
        for (const float inverse_z : {nearest_, farthest_}) {
            row.largest_coc_px =
                std::max(row.largest_coc_px, std::abs(coc_px(static_cast<double>(inverse_z))));
        }
        row.in_focus_share = in_focus_share(depths_, made.geometry, settings_.coc_limit_px);
        if (pinhole_energy > 0) row.sharpness = gradient_energy(made.image) / pinhole_energy;
        row.settings_key = keys_->of(s);
        row.picture_checksum = checksum_text(checksum);
        return row;
    }

    /// Calls `use` with the records of the sample file, and returns its result. If by_records() is true, the
    /// method of the sweep needs the records for each image, so they stay in memory. Otherwise, they are read
    /// from the file for this call and then freed.
    auto with_records(const auto& use) {
        if (by_records()) return use(maker_.frame());
        FocusFrame once(file_);
        return use(once);
    }

    /// Returns the gradient energy, a measure of the amount of detail, of the pinhole image with the same
    /// field of view as the image `made`. Compared with the gradient energy of `made`, it shows how much
    /// detail the lens blur removes.
    double pinhole_energy_for(const MadePicture& made) {
        const double zoom = made.geometry ? made.geometry->zoom : 1;
        const auto [known, is_new] = pinhole_energies_.try_emplace(zoom);
        if (is_new) {
            FocusSettings pinhole{.lens = {.focal_length_mm = 50, .f_number = HUGE_VAL},
                                  .method = FocusMethod::pinhole};
            if (zoom != 1) {
                // The pinhole image must be magnified by `zoom`, like the image `made`. The magnification is
                // proportional to the distance from the lens to the film. With Framing::lens and a focus at
                // infinity, this distance equals the focal length.
                pinhole.framing = Framing::lens;
                pinhole.lens.focal_length_mm = zoom * file_.header().film_distance_mm;
                pinhole.focus_distance_m = HUGE_VAL;
            }
            known->second = with_records(
                [&](FocusFrame& frame) { return gradient_energy(focus_picture(frame, pinhole).image); });
        }
        return known->second;
    }

    void prepare() {
        depths_ = with_records([](FocusFrame& frame) { return frame_depths(frame); });
        const auto [low, high] = std::minmax_element(depths_.inverse_z.begin(), depths_.inverse_z.end());
        farthest_ = *low;
        nearest_ = *high;
        for (const glm::dvec2& at : out_.table.at) {
            const double z_m = depth_at(file_, at.x, at.y);
            inverse_z_at_.push_back(1 / z_m);
        }
    }

    // Warns if the image `made` shows objects in curved mirrors or glass at wrong positions. Such objects
    // move nonlinearly in the image when the lens point moves, but the sample file records a linear motion.
    void warn_of_bend(const MadePicture& made) {
        if (!made.geometry || made.method == "pinhole" || made.method == "motionblur" ||
            settings_.picture.scene != nullptr ||
            settings_.picture.depth_model != DepthModel::ray_differentials)
            return;
        // The errors of position are proportional to the gain (film distance in px) times the squared
        // aperture radius, so lenses with an equal product share one computed warning.
        const double lens =
            made.geometry->gain_px * made.geometry->aperture_radius_m * made.geometry->aperture_radius_m;
        const auto [known, is_new] = bends_.try_emplace(lens);
        if (is_new) known->second = bend_warning(maker_.frame(), *made.geometry);
        if (known->second) note(*known->second);
    }

    void note(const FocusWarning& w, std::size_t pictures = 1) {
        const auto known = std::find_if(out_.warnings.begin(), out_.warnings.end(),
                                        [&](const SweepWarning& k) { return k.worst.code == w.code; });
        if (known == out_.warnings.end()) {
            out_.warnings.push_back({w, 1});
            return;
        }
        known->pictures += pictures;
        if (w.share > known->worst.share) known->worst = w;
    }

    /// Writes sweep.json with all finished images, in the sweep's order.
    void save() {
        out_.table.rows.clear();
        for (const auto& row : rows_) {
            if (row) out_.table.rows.push_back(*row);
        }
        write_text(out_.json, json_text(out_.table));
        saved_ = Clock::now();
    }

    /// Saves the finished images after an error. Further errors are ignored, so that the first one is
    /// reported.
    void save_if_possible() noexcept {
        while (!finishing_.empty()) {
            try {
                finish();
            } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the image is not recorded
            }
        }
        try {
            if (out_.made > 0) save();     // else the earlier sweep.json is complete
        } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the first error is reported
        }
    }

    const SweepSettings& settings_;
    std::filesystem::path folder_;
    SampleFileReader file_;
    SweepGrid grid_;
    std::vector<std::string> names_;
    std::vector<std::optional<SweepRow>> rows_;  ///< parallel to names_; empty until an image is finished
    PictureMaker maker_;
    std::optional<SweepKeys> keys_;  ///< present after all checks
    FrameDepths depths_;
    float nearest_ = 0, farthest_ = 0;  ///< inverse depths, 1/m
    std::vector<double> inverse_z_at_;
    std::map<double, double> pinhole_energies_;  ///< by the magnification
    std::map<double, std::optional<FocusWarning>> bends_;
    Clock::time_point saved_ = Clock::now();
    SweepResult out_;
    struct Finishing {
        std::size_t picture;
        std::future<SweepRow> row;
    };
    /// Declared last, so that its destructor waits for background tasks before the members that they use are
    /// destroyed.
    std::deque<Finishing> finishing_;
};

}  // namespace

SweepResult sweep(const std::filesystem::path& frame, const SweepSettings& settings,
                  const std::filesystem::path& folder) {
    try {
        return Sweep(frame, settings, folder).run();
    } catch (const Error& e) {
        if (e.code() != ExitCode::interrupted) throw;
        fail(ExitCode::interrupted, "interrupted; {} holds what is finished, and --resume goes on from it",
             folder.string());
    }
}

}  // namespace postlens
