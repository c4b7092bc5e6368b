// Answers the requests of the viewer's page for one frame. The page requests images, made by `focus`, `shoot`
// and `render`, and the contents of single pixels.
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

/// Answers requests from any thread. A new request for an image cancels an unfinished older one.
/// An error becomes a reply {"error": text} with status 400. Cancelled work has status 409.
class ViewSession {
  public:
    explicit ViewSession(ViewOptions options);

    /// Returns what the web page needs when it is opened: image size, camera, lens and file names.
    [[nodiscard]] ViewReply frame() const;
    /// Returns an image made by `focus`, or by `shoot` if the parameters have a shutter. The body consists
    /// of:
    /// - the length of the JSON text in bytes (32 bits, little endian)
    /// - the JSON text, and zeros up to a multiple of 4 bytes
    /// - RGB as half floats, row by row
    /// - if has_ray_share is true in the JSON, the fraction of each pixel's colour that comes from rays, as
    ///   half floats
    [[nodiscard]] ViewReply picture(const ViewParameters& parameters);
    /// Returns a preview that is made quickly because its pixels are larger. The reply has the format
    /// described at `picture`. The value "by" in its JSON is the width of a preview pixel, in px of the full
    /// image.
    [[nodiscard]] ViewReply coarse_picture(const ViewParameters& parameters);
    /// Returns an image that is made by tracing rays through the scene. The reply has the format described at
    /// `picture`. If an earlier request for such an image is still running, it is cancelled. Requests of
    /// other kinds continue.
    [[nodiscard]] ViewReply rays(const ViewParameters& parameters);
    /// Returns the surfaces that a pixel shows. If the lens is known, the answer also contains the diameter
    /// of each surface's circle of confusion. The parameters are the pixel's position x and y in px, and the
    /// lens: f-number, focal-length and focus.
    [[nodiscard]] ViewReply pixel(const ViewParameters& parameters);
    /// Returns two arrays with one value per pixel. The first contains the object ids (32 bits each). The
    /// second contains the inverse of the focus distance at which the pixel's surface is sharp (half floats,
    /// in 1/m). The inverse is used because the distance may be infinite.
    [[nodiscard]] ViewReply depths();
    /// Returns the cause of each pixel's error, i.e. of the difference between the image of `picture`, with
    /// the same parameters, and a ray-traced reference. The body of the reply consists of:
    /// - JSON as in `picture`, with a list of all causes: "name", "colour" (sRGB) and "error_share" (fraction
    ///   of the error)
    /// - one byte per pixel: the index of its cause in this list
    [[nodiscard]] ViewReply causes(const ViewParameters& parameters);
    /// Cancels the work of `causes`.
    [[nodiscard]] ViewReply drop_causes();
    /// Returns the image as a file for download. The parameter `format` is png or exr.
    [[nodiscard]] ViewReply save(const ViewParameters& parameters);
    /// Cancels all work.
    void stop();

  private:
    /// State of the requests of one kind, for example for a ray-traced image, that the web page sends to this
    /// program. Only one request of each kind runs at a time.
    struct Slot {
        std::mutex making;
        std::mutex mutex;  ///< guards `current`
        std::shared_ptr<Job> current;
    };
    /// An image made by the command `focus` or `shoot`, and the arguments of this command.
    struct MadeImage {
        std::vector<std::string> words;
        Image image;
        std::string method;
    };
    [[nodiscard]] ViewReply made(Slot& slot, const std::function<ViewReply()>& make);
    [[nodiscard]] std::vector<std::string> words_of(const ViewParameters& parameters,
                                                    const std::string& input) const;
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
