// Answers the requests of the viewer's page. The page requests images of one frame, made by the commands
// `focus`, `shoot` and `render`, and the nodes of the shading trees in a pixel.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/view/viewed_frame.h"
#include "core/job.h"
#include "planner/error_causes.h"

namespace postlens {

struct ViewOptions {
    std::string input;
    std::optional<std::string> scene;  ///< scene in which the method auto and `render` trace rays
    int port = 0;                      ///< 0: any free one
    bool open = false;                 ///< open the page in the desktop's browser
    int threads = 0;
};

/// Values of command-line options; keys are their names without "--".
using ViewParameters = std::map<std::string, std::string>;

struct ViewReply {
    int status = 200;
    std::string type = "application/json";
    std::string body;
};

/// Answers requests from any thread. A request for an image cancels an older request that is still being
/// computed. Errors become replies with status 400 and {"error": text}, or with status 409 if the work was
/// cancelled.
class ViewSession {
  public:
    explicit ViewSession(ViewOptions options);

    /// The data that the page needs at its start: size, camera, lens, file names.
    [[nodiscard]] ViewReply frame() const;
    /// Returns an image by `focus`, or by `shoot` if the parameters have a shutter. The body has four parts:
    /// the length of a JSON text in bytes (32 bits, little endian), the text, zeros up to a multiple of 4
    /// bytes, and RGB as half floats, row by row. If has_ray_share is true in the JSON, one half float per
    /// pixel follows: the fraction of the pixel that was computed by rays.
    [[nodiscard]] ViewReply picture(const ViewParameters& parameters);
    /// Returns a quick image: as `picture`, but made of fewer records (ViewedFrame::coarse). "by" in the JSON
    /// is the width of its pixels in pixels of the frame. Refuses the parameters crop and focus-at, and other
    /// programs' pictures.
    [[nodiscard]] ViewReply coarse_picture(const ViewParameters& parameters);
    /// Returns an image by `render` of the scene, in the format of `picture`. Cancels only older requests for
    /// rays.
    [[nodiscard]] ViewReply rays(const ViewParameters& parameters);
    /// Returns what a pixel shows (ViewedFrame::pixel). Parameters: x and y, px, and those of the lens.
    [[nodiscard]] ViewReply pixel(const ViewParameters& parameters);
    /// Returns the ids (32 bits each) of all pixels, then their inverse focus distances (half floats, 1/m);
    /// see ImageDepths.
    [[nodiscard]] ViewReply depths();
    /// Finds out why the image that `picture` makes with the same parameters differs from one made by rays
    /// (find_error_causes). The body begins as that of `picture`. One byte per pixel follows, its ErrorCause.
    /// The JSON lists "causes", in the order of ErrorCause, with "name", "colour" (sRGB) and "error_share".
    [[nodiscard]] ViewReply causes(const ViewParameters& parameters);
    /// Cancels the work of `causes`.
    [[nodiscard]] ViewReply drop_causes();
    /// Returns the file that the command would write. The parameter `format` is png or exr.
    [[nodiscard]] ViewReply save(const ViewParameters& parameters);
    /// Cancels all work.
    void stop();

  private:
    /// Requests of one kind. Only one of them runs at a time.
    struct Slot {
        std::mutex making;
        std::mutex mutex;  ///< guards `current`
        std::shared_ptr<Job> current;
    };
    /// An image by `focus` or `shoot`, and the words of its command.
    struct MadeImage {
        std::vector<std::string> words;
        Image image;
        std::string method;
    };
    [[nodiscard]] ViewReply made(Slot& slot, const std::function<ViewReply()>& make);
    [[nodiscard]] std::vector<std::string> words_of(const ViewParameters& parameters,
                                                    const std::string& input) const;
    /// The command for rays through the same lens. Ignores parameters that only `focus` and `shoot` have.
    [[nodiscard]] std::vector<std::string> ray_words_of(const ViewParameters& parameters) const;
    [[nodiscard]] std::shared_ptr<const MadeImage> image_of(const ViewParameters& parameters);
    [[nodiscard]] CauseMap causes_of(const ViewParameters& parameters, const MadeImage& made,
                                     const Image& reference) const;

    ViewOptions options_;
    std::unique_ptr<ViewedFrame> frame_;
    nlohmann::ordered_json facts_;  ///< facts about the frame
    Slot pictures_, rays_, pixels_, depths_, causes_;
    std::mutex last_mutex_;                  ///< guards `last_`
    std::shared_ptr<const MadeImage> last_;  ///< image that `picture` made last
    std::atomic<bool> stopped_{false};
};

}  // namespace postlens
