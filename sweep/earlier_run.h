// Finds images that an earlier run of a sweep made with the same settings, so that this run need not make
// them again.
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

/// Returns the checksum (XXH3) of a file's bytes, in the form in which the table stores it. Empty if the file
/// cannot be read.
[[nodiscard]] std::string file_checksum_text(const std::filesystem::path& path);

/// Keys that identify the images of a sweep (SweepRow::settings_key). Images with equal keys are equal.
class SweepKeys {
  public:
    /// `exposure_stops`: exposure of all images. `at`: raster positions, px, at which the CoC is reported.
    SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
              FocusMethod method, const std::vector<glm::dvec2>& at);
    [[nodiscard]] std::string of(const SweepSetting& s) const { return key(s, predicted_); }
    /// True if an image with this key can stay: it is the same image, with at least the same figures.
    [[nodiscard]] bool fits(const std::string& earlier, const SweepSetting& s) const {
        return earlier == of(s) || earlier == key(s, true);
    }

  private:
    [[nodiscard]] std::string key(const SweepSetting& s, bool predicted) const;

    std::string common_;      ///< everything on which all images of the sweep depend
    bool predicted_ = false;  ///< their errors are predicted
};

/// Returns table rows of earlier runs, by file name. They are read from the table `json`. A run of the whole
/// sweep also reads the tables of its shares (parts that several machines have made), so a name may have
/// several rows. Empty if `settings.resume` is not set.
[[nodiscard]] std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& json);

}  // namespace postlens
