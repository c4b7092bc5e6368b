// The frame that the viewer shows: a sample file, or an image made by another program.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/view/image_depths.h"

namespace postlens {

/// The sample file or image that the viewer shows. It answers the requests of the viewer's web page. Several
/// threads may call it at the same time.
class ViewedFrame {
  public:
    ViewedFrame() = default;
    virtual ~ViewedFrame() = default;
    ViewedFrame(const ViewedFrame&) = delete;
    ViewedFrame& operator=(const ViewedFrame&) = delete;
    ViewedFrame(ViewedFrame&&) = delete;
    ViewedFrame& operator=(ViewedFrame&&) = delete;

    /// Returns facts about the viewed file as JSON, as the command `info` reports them. They contain at
    /// least:
    /// - width and height, in px
    /// - pixel_pitch_mm, film_distance_mm and focal_length_mm, from which the circles of confusion are
    ///   computed
    /// - f_number, focus_m (the focus distance; "inf" means infinity) and nearest_m (the smallest depth),
    ///   each of which is null if it is unknown
    [[nodiscard]] virtual nlohmann::ordered_json facts() const = 0;
    [[nodiscard]] virtual ImageDepths depths() const = 0;
    /// Returns what the pixel at a raster position shows, as JSON:
    /// - "nodes" lists the surfaces seen directly, by reflection or by refraction, the brightest first. Each
    ///   has "share" (of the light), "id", "name", "z_m" and, if the lens is known, "coc_px".
    /// - "clicked" is the surface on which a click focuses, with "name" and "focus_m" (null means infinity).
    ///   It is null if the file stores nothing there.
    /// Throws Error(wrong_arguments) if the position or the lens is out of range.
    [[nodiscard]] virtual nlohmann::ordered_json pixel(double x, double y, const LensOptions& lens) const = 0;
    /// Returns the sample file that the viewer has opened. It stays open with its records in memory, so that
    /// the viewer can make further images of it without reading it again. Returns null if the frame is an
    /// image of another program.
    [[nodiscard]] virtual std::shared_ptr<KeptFrame> kept() const { return nullptr; }
    /// A reduced sample file for quick images. Its pixels are `by` times as wide and high as those of the
    /// full image.
    struct Records {
        std::string input;
        std::shared_ptr<KeptFrame> kept;
        int by = 1;
    };
    /// Returns a sample file from which images are made quickly. It has fewer and larger pixels than the
    /// viewed file (Records::by). If the viewed file is already small, returns this file itself, with `by` =
    /// 1. Throws Error(wrong_arguments) if the frame is an image of another program.
    [[nodiscard]] virtual Records coarse() const = 0;
};

/// Opens the file `input`, which is either a sample file or another program's image. Throws
/// Error(invalid_input) if it is neither. Also throws all errors that occur when a sample file or an image is
/// read.
[[nodiscard]] std::unique_ptr<ViewedFrame> open_viewed_frame(const std::string& input);

/// Returns a focus distance in metres as JSON: null if there is none, "inf" for infinity.
[[nodiscard]] nlohmann::ordered_json focus_fact(const std::optional<double>& focus_m);

/// These functions open the two kinds of frames.
[[nodiscard]] std::unique_ptr<ViewedFrame> view_records(const std::string& input,
                                                        nlohmann::ordered_json info);
[[nodiscard]] std::unique_ptr<ViewedFrame> view_foreign_picture(const std::string& input,
                                                                nlohmann::ordered_json info);

}  // namespace postlens
