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
    /// Returns what is visible at a position of the image, as JSON:
    /// - "nodes" lists the visible surfaces, seen directly, by reflection or by refraction, the brightest
    ///   first. Each has "share" (its fraction of the pixel's light), "id" and "name" of its object, "z_m"
    ///   (depth in m) and, if `lens` is complete, "coc_px" (diameter of the circle of confusion).
    /// - "clicked" is the surface on which a click focuses, with "name" and "focus_m" (null means infinity).
    ///   It is null if the file stores no surface at this position.
    /// Throws Error(wrong_arguments) if the position or the lens is out of range.
    [[nodiscard]] virtual nlohmann::ordered_json pixel(double x, double y, const LensOptions& lens) const = 0;
    /// Returns the sample file that is viewed. It stays open with its records in memory, so that the viewer
    /// can make further images of it without reading it again. Returns null if the viewed file is not a
    /// sample file.
    [[nodiscard]] virtual std::shared_ptr<KeptFrame> kept() const { return nullptr; }
    /// A sample file with reduced resolution, from which images are made quickly. One of its pixels is as
    /// large as `by` x `by` pixels of the viewed file.
    struct Records {
        std::string input;
        std::shared_ptr<KeptFrame> kept;
        int by = 1;
    };
    /// Returns a sample file with fewer pixels, from which images are made quickly. Its pixels are
    /// Records::by times as wide and high as those of the viewed file. If the viewed file is already small,
    /// returns this file itself, with `by` = 1. Throws Error(wrong_arguments) if the viewed file is not a
    /// sample file.
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
