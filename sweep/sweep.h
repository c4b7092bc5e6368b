// Makes images of one sample file with many lens settings. Also writes a table of measured values and a
// contact sheet.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/share.h"
#include "focus/focus.h"
#include "sweep/grid.h"
#include "sweep/picture_maker.h"
#include "sweep/sweep_table.h"

namespace postlens {

struct SweepSettings {
    SweepAxes axes;
    PictureSettings picture;
    std::string format = "exr";  ///< extension of the images: exr, png, tif or jpg
    /// numbered names such as "pull.%04d"; if absent, names contain the settings
    std::optional<std::string> frames;
    std::vector<glm::dvec2> at;  ///< raster positions, px, at which the CoC is reported; empty: a 3 x 3 grid
    double coc_limit_px = 1;     ///< CoC diameter below which a pixel is in focus, px; positive
    /// Keeps an image of an earlier run in the same folder if two conditions hold: sweep.json shows that it
    /// was made with equal settings from an equal file, and its checksum shows that it is unchanged.
    bool resume = false;
    /// Makes only every N-th image (a share of the sweep). The table of these images is sweep.I-of-N.json;
    /// sweep.csv and contact.png are not written. A later sweep of all images with `resume` in the same
    /// folder keeps the images of all shares, and writes the tables and the contact sheet.
    std::optional<Share> share;
    std::string part;      ///< JSON that a share's table stores under the key "part"; empty: none
    Join join = Join::no;  ///< with `resume`: makes no image
    /// Further files on which the images depend, such as files that the settings refer to. Their contents are
    /// part of every settings_key.
    std::vector<std::filesystem::path> depends_on;
    Damage damage = Damage::refuse;        ///< handling of damage in the sample file
    std::optional<double> exposure_stops;  ///< exposure of all images; absent: the file's
};

struct SweepWarning {
    FocusWarning worst;        ///< warning of the image with the largest affected fraction of pixels
    std::size_t pictures = 0;  ///< number of images with this warning
};

struct SweepResult {
    SweepTable table;
    std::vector<SweepWarning> warnings;  ///< one per code, for the images that this run has made
    std::size_t made = 0, kept = 0;
    std::filesystem::path csv, json;
    std::optional<std::filesystem::path> contact_sheet;  ///< absent above ContactSheet::most_pictures
};

/// Writes the images, sweep.csv, sweep.json and contact.png into `folder`, which is created if it does not
/// exist. Every file is written atomically. sweep.json is updated about once a second and when the sweep is
/// interrupted. The images are those of PictureMaker. Throws Error(wrong_arguments) for settings out of
/// range, before anything is written. Throws Error(cannot_write), and the errors of PictureMaker.
[[nodiscard]] SweepResult sweep(const std::filesystem::path& frame, const SweepSettings& settings,
                                const std::filesystem::path& folder);

}  // namespace postlens
