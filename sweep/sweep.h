// Makes images of one sample file with many lens settings, a contact sheet and a table.
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
    /// Pattern for numbered file names, such as "pull.%04d". If absent, file names contain the settings.
    std::optional<std::string> frames;
    std::vector<glm::dvec2> at;  ///< raster positions, px, at which the CoC is reported; empty: a 3 x 3 grid
    double coc_limit_px = 1;     ///< CoC diameter below which a pixel is in focus, px; positive
    /// Keeps images of an earlier run in the same folder if sweep.json states equal settings, an equal sample
    /// file and the image's checksum.
    bool resume = false;
    /// The share of this computer, if several computers divide a sweep: `I` of `N` shares. It makes only
    /// every N-th image, and writes the table sweep.I-of-N.json.
    ///
    /// When all computers have finished, the results are joined by a last run, which has `resume` but no
    /// `share`. It keeps the images of all computers, and writes sweep.csv and contact.png.
    std::optional<Share> share;
    std::string part;      ///< JSON that a share's table stores under the key "part"; empty: none
    Join join = Join::no;  ///< if not `no`, with `resume`: no image is made
    /// Paths of other input files on which the images depend, for example a file with the motion of objects.
    /// If the contents of one of these files have changed since an earlier run, no image of that run is kept.
    std::vector<std::filesystem::path> depends_on;
    Damage damage = Damage::refuse;        ///< handling of damage in the sample file
    std::optional<double> exposure_stops;  ///< exposure of all images; absent: the file's
};

struct SweepWarning {
    FocusWarning worst;        ///< warning of the image with the largest fraction of affected pixels
    std::size_t pictures = 0;  ///< number of images with this warning
};

struct SweepResult {
    SweepTable table;
    std::vector<SweepWarning> warnings;  ///< one per warning code, for the images that this run made
    std::size_t made = 0, kept = 0;
    std::vector<std::string> missing;  ///< with Join::partial: files of images that are left out
    std::filesystem::path csv, json;
    std::optional<std::filesystem::path> contact_sheet;  ///< absent above ContactSheet::most_pictures
};

/// Writes the images, sweep.csv, sweep.json and contact.png into `folder`, which is created if needed. Files
/// are written atomically, and sweep.json about once a second.
///
/// Throws Error(wrong_arguments) before anything is written. Throws Error(cannot_write) and the errors of
/// PictureMaker.
[[nodiscard]] SweepResult sweep(const std::filesystem::path& frame, const SweepSettings& settings,
                                const std::filesystem::path& folder);

}  // namespace postlens
