// Finds images of an earlier run of a sweep that equal images of this run.
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

/// Checksum (XXH3) of a file's bytes, in the form that the table has. Empty if the file cannot be read.
[[nodiscard]] std::string file_checksum_text(const std::filesystem::path& path);
[[nodiscard]] std::string checksum_text(std::uint64_t checksum);

/// Keys of the images of a sweep. Images with equal keys are equal (SweepRow::settings_key).
class SweepKeys {
  public:
    /// `exposure_stops`: exposure of all images; `at`: raster positions to report the CoC of, px.
    SweepKeys(const std::filesystem::path& frame, const SweepSettings& settings, double exposure_stops,
              FocusMethod method, const std::vector<glm::dvec2>& at);
    [[nodiscard]] std::string of(const SweepSetting& s) const;

  private:
    std::string common_;  ///< what all images of the sweep depend on
};

/// Table rows of earlier runs, by file name. They are read from the table `json` and, if this run makes the
/// whole sweep, also from the tables of all shares, so that a name may have several rows. Empty unless
/// `settings.resume` is set.
[[nodiscard]] std::multimap<std::string, SweepRow> earlier_rows(const SweepSettings& settings,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& json);

}  // namespace postlens
