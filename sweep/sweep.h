// Makes images of one sample file with many lens settings, with a table of figures and a contact sheet.
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
    std::string format = "exr";         ///< extension of the images: exr, png, tif or jpg
    std::optional<std::string> frames;  ///< numbered names, e.g. "pull.%04d"; absent: by settings
    std::vector<glm::dvec2> at;         ///< raster positions to report the CoC of, px; empty: a 3 x 3 grid
    double coc_limit_px = 1;            ///< CoC diameter below which a pixel is in focus, px; positive
    /// Keep an image of an earlier run in the same folder if sweep.json shows that it was made with equal
    /// settings from an equal file, and if its checksum shows that it is unchanged.
    bool resume = false;
    /// Makes only every N-th image. Their table is sweep.I-of-N.json; there is neither sweep.csv nor
    /// contact.png. A later sweep of all images with `resume` in the same folder keeps the images of all
    /// shares, and writes the tables and the contact sheet.
    std::optional<Share> share;
    std::string part;      ///< JSON that the table of a share states as "part"; empty: none
    Join join = Join::no;  ///< with `resume`: makes no image
    /// Further files that the images depend on, such as files that the settings name. Their contents are part
    /// of every settings_key.
    std::vector<std::filesystem::path> depends_on;
    Damage damage = Damage::refuse;        ///< handling of damage in the sample file
    std::optional<double> exposure_stops;  ///< exposure of all images; absent: the file's
};

struct SweepWarning {
    FocusWarning worst;        ///< the warning of the image with the largest share
    std::size_t pictures = 0;  ///< number of images with this warning
};

struct SweepResult {
    SweepTable table;
    std::vector<SweepWarning> warnings;  ///< one per code; of images made by this run
    std::size_t made = 0, kept = 0;
    std::filesystem::path csv, json;
    std::optional<std::filesystem::path> contact_sheet;  ///< absent above ContactSheet::most_pictures
};

/// Writes the images, sweep.csv, sweep.json and contact.png into `folder`, which is created if needed. Every
/// file is written atomically. sweep.json is updated about once a second and on interruption. The images are
/// those of PictureMaker. Throws Error(wrong_arguments) for settings out of range, before anything is
/// written, Error(cannot_write), and the errors of PictureMaker.
[[nodiscard]] SweepResult sweep(const std::filesystem::path& frame, const SweepSettings& settings,
                                const std::filesystem::path& folder);

}  // namespace postlens
