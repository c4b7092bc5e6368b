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
    /// Pattern for the file names of the images, such as "pull.%04d", in which %04d is replaced by the
    /// image's number. If absent, the name of an image is made from its settings, such as focus distance and
    /// f-number.
    std::optional<std::string> frames;
    std::vector<glm::dvec2> at;  ///< raster positions, px, at which the CoC is reported; empty: a 3 x 3 grid
    double coc_limit_px = 1;     ///< CoC diameter below which a pixel is in focus, px; positive
    /// Whether to keep images that an earlier run has made in the same folder. An image is kept if the file
    /// sweep.json of that run contains equal settings, the checksum of an equal sample file, and the checksum
    /// of the image. Otherwise, the image is made again.
    bool resume = false;
    /// Which share of the sweep this computer makes, if several computers divide it: `I` of `N` shares. Each
    /// computer makes every N-th image, and writes a table of these images, sweep.I-of-N.json. One more run
    /// with `resume`, but without `share`, then joins the results.
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

/// Makes the images of the sweep, and writes them with sweep.csv, sweep.json and contact.png into `folder`,
/// which is created if needed. Files are written atomically, and sweep.json about once a second.
///
/// If settings are wrong, throws Error(wrong_arguments) before anything is written. Throws
/// Error(cannot_write), and the errors that the class PictureMaker throws while it makes an image.
[[nodiscard]] SweepResult sweep(const std::filesystem::path& frame, const SweepSettings& settings,
                                const std::filesystem::path& folder);

}  // namespace postlens
