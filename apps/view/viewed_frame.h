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

    /// Returns what `info` reports about the file, at least:
    /// - width and height
    /// - pixel_pitch_mm, film_distance_mm and focal_length_mm, for the circles of confusion
    /// - f_number, focus_m ("inf" means infinity) and nearest_m (the smallest depth), or null if they are
    ///   unknown
    [[nodiscard]] virtual nlohmann::ordered_json facts() const = 0;
    [[nodiscard]] virtual ImageDepths depths() const = 0;
    /// Returns what the pixel at a raster position shows, as JSON:
    /// - "nodes" lists the surfaces seen directly, by reflection or by refraction, the brightest first. Each
    ///   has "share" (of the light), "id", "name", "z_m" and, if the lens is known, "coc_px".
    /// - "clicked" is the surface on which a click focuses, with "name" and "focus_m" (null means infinity).
    ///   It is null if the file stores nothing there.
    /// Throws Error(wrong_arguments) if the position or the lens is out of range.
    [[nodiscard]] virtual nlohmann::ordered_json pixel(double x, double y, const LensOptions& lens) const = 0;
    /// Returns the opened sample file, which is used again for further images. Null if the file is not a
    /// sample file.
    [[nodiscard]] virtual std::shared_ptr<KeptFrame> kept() const { return nullptr; }
    /// A reduced sample file for quick images. Its pixels are `by` times as wide and high as those of the
    /// full image.
    struct Records {
        std::string input;
        std::shared_ptr<KeptFrame> kept;
        int by = 1;
    };
    /// Returns a reduced sample file for quick images, or the original if it is small. Throws
    /// Error(wrong_arguments) for an image of another program.
    [[nodiscard]] virtual Records coarse() const = 0;
};

/// Opens a sample file, or reads another program's image. Throws Error(invalid_input) if the file is neither,
/// and the errors of the readers.
[[nodiscard]] std::unique_ptr<ViewedFrame> open_viewed_frame(const std::string& input);

/// Returns a focus distance in metres as JSON: null if there is none, "inf" for infinity.
[[nodiscard]] nlohmann::ordered_json focus_fact(const std::optional<double>& focus_m);

/// These functions open the two kinds of frames.
[[nodiscard]] std::unique_ptr<ViewedFrame> view_records(const std::string& input,
                                                        nlohmann::ordered_json info);
[[nodiscard]] std::unique_ptr<ViewedFrame> view_foreign_picture(const std::string& input,
                                                                nlohmann::ordered_json info);

}  // namespace postlens
