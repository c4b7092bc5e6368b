// Answers the requests of the viewer's page for one frame. The page requests images, which the commands
// `focus`, `shoot` and `render` make. It also requests the contents of single pixels.
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
    int port = 0;                      ///< 0 means any free port
    bool open = false;                 ///< open the page in the desktop's browser
    int threads = 0;
};

/// Values of command-line options. A key is the name of an option without "--".
using ViewParameters = std::map<std::string, std::string>;

struct ViewReply {
    int status = 200;
    std::string type = "application/json";
    std::string body;
};

/// Answers requests from any thread. A new request for an image cancels an older, unfinished one. An error
/// becomes a reply with status 400 and {"error": text}. If the work was cancelled, the status is 409.
class ViewSession {
  public:
    explicit ViewSession(ViewOptions options);

    /// Returns what the page needs at its start: size, camera, lens and file names.
    [[nodiscard]] ViewReply frame() const;
    /// Returns an image made by `focus`, or by `shoot` if the parameters have a shutter. The body begins with
    /// a JSON text: its length in bytes (32 bits, little endian), the text, and zeros up to a multiple of 4
    /// bytes. RGB follows as half floats, row by row. If has_ray_share is true in the JSON, one more half
    /// float per pixel follows: the fraction of the pixel's colour that comes from rays.
    [[nodiscard]] ViewReply picture(const ViewParameters& parameters);
    /// Returns a quick image in the format of `picture`, made from fewer records (ViewedFrame::coarse). Each
    /// of its pixels is as wide as N pixels of the frame, where N is the number "by" in the JSON. The
    /// parameters crop and focus-at are refused, and so are images of other programs.
    [[nodiscard]] ViewReply coarse_picture(const ViewParameters& parameters);
    /// Returns an image of the scene made by `render`, that is, only by rays, in the format of `picture`.
    /// Cancels older requests for images by `render`, but no other requests.
    [[nodiscard]] ViewReply rays(const ViewParameters& parameters);
    /// Returns what a pixel shows (ViewedFrame::pixel). The parameters are the position, x and y in px, and
    /// the lens: f-number, focal-length and focus.
    [[nodiscard]] ViewReply pixel(const ViewParameters& parameters);
    /// Returns the ids of all pixels (32 bits each), followed by the inverse focus distances of all pixels
    /// (half floats, in 1/m). See ImageDepths.
    [[nodiscard]] ViewReply depths();
    /// Returns the cause of each pixel's error in the image that `picture` returns for the same parameters.
    /// The image is compared with a ray-traced reference (find_error_causes). The body begins like that of
    /// `picture`, with a JSON text. One byte per pixel follows: the number of its ErrorCause. The JSON lists
    /// the causes in the order of these numbers, each with "name", "colour" (sRGB) and "error_share".
    [[nodiscard]] ViewReply causes(const ViewParameters& parameters);
    /// Cancels the work of `causes`.
    [[nodiscard]] ViewReply drop_causes();
    /// Returns the image as a file, as `focus` or `shoot` would write it. The parameter `format` is png or
    /// exr.
    [[nodiscard]] ViewReply save(const ViewParameters& parameters);
    /// Cancels all work.
    void stop();

  private:
    /// State of one kind of request. Only one request of each kind runs at a time.
    struct Slot {
        std::mutex making;
        std::mutex mutex;  ///< guards `current`
        std::shared_ptr<Job> current;
    };
    /// An image made by `focus` or `shoot`, and the arguments of the command that made it.
    struct MadeImage {
        std::vector<std::string> words;
        Image image;
        std::string method;
    };
    [[nodiscard]] ViewReply made(Slot& slot, const std::function<ViewReply()>& make);
    [[nodiscard]] std::vector<std::string> words_of(const ViewParameters& parameters,
                                                    const std::string& input) const;
    /// Returns the words of a `render` command with the lens and shutter of `parameters`. Leaves out
    /// parameters that `render` does not have.
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
