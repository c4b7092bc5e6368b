// Finds images that an earlier run of a sweep made with the same settings. The current run can then keep
// them.
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

/// Returns the XXH3 checksum of a file's bytes, in the text form that the table of the sweep stores. Empty if
/// the file cannot be read.
[[nodiscard]] std::string file_checksum_text(const std::filesystem::path& path);

/// Computes a key for each image of a sweep (SweepRow::settings_key) from the settings and the contents of
/// the input files. If two images have the same key, they are equal.
class SweepKeys {
  public:
    /// `exposure_stops` is the exposure of all images, in stops. `at` lists the raster positions, in px, at
    /// which the CoC (circle of confusion) is reported.
    SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
              FocusMethod method, const std::vector<glm::dvec2>& at);
    [[nodiscard]] std::string of(const SweepSetting& s) const { return key(s, predicted_); }
    /// Returns true if an image of an earlier run can be kept, i.e. if its key `earlier` belongs to the
    /// settings `s`. If this sweep predicts no errors, images with a predicted error can be kept, too.
    [[nodiscard]] bool fits(const std::string& earlier, const SweepSetting& s) const {
        return earlier == of(s) || earlier == key(s, true);
    }

  private:
    [[nodiscard]] std::string key(const SweepSetting& s, bool predicted) const;

    std::string common_;      ///< settings and contents that all images of the sweep share
    bool predicted_ = false;  ///< true if the errors of the images are predicted
};

/// Reads the rows that earlier runs wrote to the table `json`, and returns them by file name. A run of the
/// whole sweep also reads the tables of its shares (parts of the sweep that ran separately). A file name may
/// therefore have several rows. The result is empty if `settings.resume` is not set.
[[nodiscard]] std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& json);

}  // namespace postlens
