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
#include "core/job.h"

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
    /// Returns an image by `render` of the scene, in the format of `picture`. Cancels only older requests for
    /// rays.
    [[nodiscard]] ViewReply rays(const ViewParameters& parameters);
    /// Returns the visible nodes of a pixel, each with the focus distance that brings it into focus. Nodes of
    /// the same object and path are merged. The nodes are sorted by their fraction of the pixel's light.
    /// Parameters: x and y, px.
    [[nodiscard]] ViewReply pixel(const ViewParameters& parameters);
    /// Returns the ids (32 bits each) of the brightest visible node in all pixels, then the inverse focus
    /// distances of these nodes (half floats, 1/m); see ImageDepths.
    [[nodiscard]] ViewReply depths();
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
    [[nodiscard]] ViewReply made(Slot& slot, const std::function<ViewReply()>& make);
    [[nodiscard]] std::vector<std::string> words_of(const ViewParameters& parameters) const;

    ViewOptions options_;
    CommandResult info_;
    std::shared_ptr<KeptFrame> kept_;  ///< null for another program's image
    Slot pictures_, rays_, others_;
    std::atomic<bool> stopped_{false};
};

}  // namespace postlens
