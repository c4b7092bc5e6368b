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
    /// A sweep is a series of images of one sample file with different lens settings. A key is a hash of all
    /// inputs of an image.
    /// - `frame`: path of the sample file
    /// - `exposure_stops`: exposure of all images of the sweep
    /// - `at`: raster positions, in px, at which the circle of confusion is reported
    SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
              FocusMethod method, const std::vector<glm::dvec2>& at);
    [[nodiscard]] std::string of(const SweepSetting& s) const { return key(s, predicted_); }
    /// Compares keys, which are hashes of an image's settings. Returns true if the image with the key
    /// `earlier`, from an earlier run, can be kept for the settings `s`. An image whose error was predicted
    /// is kept even if this run predicts no errors.
    [[nodiscard]] bool fits(const std::string& earlier, const SweepSetting& s) const {
        return earlier == of(s) || earlier == key(s, true);
    }

  private:
    [[nodiscard]] std::string key(const SweepSetting& s, bool predicted) const;

    std::string common_;      ///< settings and contents that all images of the sweep share
    bool predicted_ = false;  ///< true if the errors of the images are predicted
};

/// Returns the table rows of images that earlier runs made, keyed by file name. They are read from `json`
/// and, if several machines shared the sweep, from their tables. Returns nothing unless `settings.resume` is
/// set.
[[nodiscard]] std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& json);

}  // namespace postlens
