// Finds images that an earlier run of a sweep made with the same settings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "focus/focus.h"
#include "sweep/grid.h"
#include "sweep/sweep.h"
#include "sweep/sweep_table.h"

namespace postlens {

/// Returns the XXH3 checksum of a file's bytes as text, or nothing if it cannot be read.
[[nodiscard]] std::string file_checksum_text(const std::filesystem::path& path);

/// Computes a key for each image from its settings and input files. Images with the same key are equal.
class SweepKeys {
  public:
    /// The key of an image is a hash of all inputs on which the image depends.
    /// - `frame`: path of the sample file
    /// - `exposure_stops`: exposure of all images of the sweep
    /// - `at`: raster positions, in px, at which the circle of confusion is reported
    SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
              FocusMethod method, const std::vector<glm::dvec2>& at);
    [[nodiscard]] std::string of(const SweepSetting& s) const { return key(s, predicted_); }
    /// Returns whether an image from an earlier run can be kept, because it was made with the settings `s`.
    /// `earlier` is the key of the earlier image, which is a hash of its settings. An image with a predicted
    /// error is kept even if this run does not predict errors.
    [[nodiscard]] bool fits(const std::string& earlier, const SweepSetting& s) const {
        return earlier == of(s) || earlier == key(s, true);
    }

  private:
    [[nodiscard]] std::string key(const SweepSetting& s, bool predicted) const;

    std::string common_;      ///< settings and contents that all images of the sweep share
    bool predicted_ = false;  ///< true if the errors of the images are predicted
};

/// Returns the table rows of images from earlier runs, by file name. They are read from the file `json`. If
/// `settings.share` is not set, the tables of all machines that shared the sweep are read too. Returns
/// nothing unless `settings.resume` is set.
[[nodiscard]] std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& json);

}  // namespace postlens
