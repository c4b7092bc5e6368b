// The frame that the viewer shows: a sample file, or an image of another program.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/view/image_depths.h"

namespace postlens {

/// Answers the requests of the viewer's page about a frame. All functions may be called from several threads
/// at once.
class ViewedFrame {
  public:
    ViewedFrame() = default;
    virtual ~ViewedFrame() = default;
    ViewedFrame(const ViewedFrame&) = delete;
    ViewedFrame& operator=(const ViewedFrame&) = delete;
    ViewedFrame(ViewedFrame&&) = delete;
    ViewedFrame& operator=(ViewedFrame&&) = delete;

    /// The facts that `info` reports about the file. They include at least: width, height; pixel_pitch_mm,
    /// film_distance_mm and focal_length_mm, from which the page computes circles of confusion; f_number,
    /// focus_m and nearest_m, each null if it is unknown. A focus at infinity is the text "inf".
    [[nodiscard]] virtual nlohmann::ordered_json facts() const = 0;
    [[nodiscard]] virtual ImageDepths depths() const = 0;
    /// The contents of the pixel at a raster position. "nodes": the nodes, sorted by their share of the
    /// pixel's light, each with "share", "id", "name", "z_m" and, if the lens is known, "coc_px". "clicked":
    /// the node or depth on which a click focuses, with "name" and "focus_m" (null: infinity). "clicked" is
    /// null if the file stores nothing there. Throws Error(wrong_arguments) for a position or a lens out of
    /// range.
    [[nodiscard]] virtual nlohmann::ordered_json pixel(double x, double y, const LensOptions& lens) const = 0;
    /// The open sample file, for parse_command_line; null for another program's image.
    [[nodiscard]] virtual std::shared_ptr<KeptFrame> kept() const { return nullptr; }
    /// A sample file, and its open reader. Its pixels are `by` times as wide and as high as those of the
    /// frame.
    struct Records {
        std::string input;
        std::shared_ptr<KeptFrame> kept;
        int by = 1;
    };
    /// Fewer records of the frame, for quick images, in a temporary file (write_coarser_file). If a frame has
    /// few records, its own file is returned. Throws Error(wrong_arguments) if the frame is another program's
    /// image.
    [[nodiscard]] virtual Records coarse() const = 0;
};

/// Opens a frame. Another program's image is read completely. Throws Error(invalid_input) for other files,
/// and the errors of the readers.
[[nodiscard]] std::unique_ptr<ViewedFrame> open_viewed_frame(const std::string& input);

/// The fact focus_m: null without a value.
[[nodiscard]] nlohmann::ordered_json focus_fact(const std::optional<double>& focus_m);

/// The two kinds of frames.
[[nodiscard]] std::unique_ptr<ViewedFrame> view_records(const std::string& input,
                                                        nlohmann::ordered_json info);
[[nodiscard]] std::unique_ptr<ViewedFrame> view_foreign_picture(const std::string& input,
                                                                nlohmann::ordered_json info);

}  // namespace postlens
