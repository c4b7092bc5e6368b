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
    /// `exposure_stops` applies to all images of the sweep. `at` lists the raster positions, in px, at which
    /// the circle of confusion is reported.
    SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
              FocusMethod method, const std::vector<glm::dvec2>& at);
    [[nodiscard]] std::string of(const SweepSetting& s) const { return key(s, predicted_); }
    /// Returns true if `earlier`, the key (hash) of an earlier image, matches the settings `s`. The earlier
    /// image may also have a predicted error.
    [[nodiscard]] bool fits(const std::string& earlier, const SweepSetting& s) const {
        return earlier == of(s) || earlier == key(s, true);
    }

  private:
    [[nodiscard]] std::string key(const SweepSetting& s, bool predicted) const;

    std::string common_;      ///< settings and contents that all images of the sweep share
    bool predicted_ = false;  ///< true if the errors of the images are predicted
};

/// Reads the table rows of earlier images, keyed by file name, from `json` and the tables of machines that
/// shared the sweep. Empty unless `settings.resume` is set.
[[nodiscard]] std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& json);

}  // namespace postlens
