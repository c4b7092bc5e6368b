// Answers the requests of the viewer's page: images of one frame by the command's own options, and the nodes
// of a pixel.
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
    std::optional<std::string> scene;  ///< for method auto and for rays
    int port = 0;                      ///< 0: any free one
    bool open = false;                 ///< in the desktop's browser
    int threads = 0;
};

/// Options of the command by their names without "--".
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

    /// What the page shows at first: size, camera, lens, names.
    [[nodiscard]] ViewReply frame() const;
    /// A picture by `focus`, or by `shoot` where there is a shutter: the length of a JSON text in bytes (32
    /// bits, little endian), the text, zeros up to a multiple of 4, RGB as half floats, row by row, and,
    /// where the JSON says has_ray_share, a half float a pixel: the share of its view samples that are rays.
    [[nodiscard]] ViewReply picture(const ViewParameters& parameters);
    /// `render` of the scene: likewise. Cancels other rays only.
    [[nodiscard]] ViewReply rays(const ViewParameters& parameters);
    /// The node that gives most of a pixel's light, with the distance in focus that makes it sharp, and all
    /// nodes of the pixel. Parameters x and y, px.
    [[nodiscard]] ViewReply pixel(const ViewParameters& parameters);
    /// Of every pixel the inverse depth of its image (half floats, 1/m, 0: infinite), and the object's id (32
    /// bits): of the node that gives most light; in this order.
    [[nodiscard]] ViewReply depths();
    /// The file that the command would write: parameter `format` png or exr.
    [[nodiscard]] ViewReply save(const ViewParameters& parameters);
    /// Cancels all work.
    void stop();

  private:
    /// One picture at a time of each kind.
    struct Slot {
        std::mutex making;
        std::mutex mutex;  ///< of `current`
        std::shared_ptr<Job> current;
    };
    [[nodiscard]] ViewReply made(Slot& slot, const std::function<ViewReply()>& make);
    [[nodiscard]] std::vector<std::string> words_of(const ViewParameters& parameters) const;

    ViewOptions options_;
    CommandResult info_;
    std::shared_ptr<KeptFrame> kept_;  ///< absent: another program's picture
    Slot pictures_, rays_, others_;
    std::atomic<bool> stopped_{false};
};

}  // namespace postlens
