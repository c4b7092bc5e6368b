// Answers the requests of the viewer's page. The page asks for images of one frame, which the commands
// `focus`, `shoot` and `render` make, and for the nodes of the shading trees in a pixel.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "apps/command.h"
#include "core/job.h"

namespace postlens {

struct ViewOptions {
    std::string input;
    std::optional<std::string> scene;  ///< for the method auto and for rays
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

/// Answers requests from any thread. A request for an image cancels an older one that is still being
/// computed. Errors become replies: status 400 with {"error": text}, or 409 if the work was cancelled.
class ViewSession {
  public:
    explicit ViewSession(ViewOptions options);

    /// What the page needs at its start: size, camera, lens, file names.
    [[nodiscard]] ViewReply frame() const;
    /// An image by `focus`, or by `shoot` if the parameters have a shutter. The body has the length of a JSON
    /// text in bytes (32 bits, little endian), the text, zeros up to a multiple of 4, and RGB as half floats,
    /// row by row. If has_ray_share is true in the JSON, one half float per pixel follows: the share of its
    /// view samples that rays replaced.
    [[nodiscard]] ViewReply picture(const ViewParameters& parameters);
    /// An image by `render` of the scene, in the format of `picture`. Cancels only older requests for rays.
    [[nodiscard]] ViewReply rays(const ViewParameters& parameters);
    /// The visible nodes of a pixel, merged by object and path and sorted by their share of the pixel's
    /// light, each with the focus distance that brings it into focus. Parameters x and y, px.
    [[nodiscard]] ViewReply pixel(const ViewParameters& parameters);
    /// For the brightest visible node of every pixel (ImageDepths): all ids (32 bits each), then all inverse
    /// focus distances (half floats, 1/m).
    [[nodiscard]] ViewReply depths();
    /// The file that the command would write. Its format is the parameter `format`, png or exr.
    [[nodiscard]] ViewReply save(const ViewParameters& parameters);
    /// Cancels all work.
    void stop();

  private:
    /// Requests of one kind, of which one runs at a time.
    struct Slot {
        std::mutex making;
        std::mutex mutex;  ///< guards `current`
        std::shared_ptr<Job> current;
    };
    [[nodiscard]] ViewReply made(Slot& slot, const std::function<ViewReply()>& make);
    [[nodiscard]] std::vector<std::string> words_of(const ViewParameters& parameters) const;

    ViewOptions options_;
    CommandResult info_;
    std::shared_ptr<KeptFrame> kept_;  ///< null for another program's image
    Slot pictures_, rays_, others_;
    std::atomic<bool> stopped_{false};
};

}  // namespace postlens
