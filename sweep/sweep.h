// One sample file, many lenses: a folder of pictures with a table and a contact sheet.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "focus/focus.h"
#include "sweep/grid.h"
#include "sweep/picture_maker.h"
#include "sweep/sweep_table.h"

namespace postlens {

struct SweepSettings {
    SweepAxes axes;
    PictureSettings picture;
    std::string format = "exr";         ///< ending of the pictures: exr, png, tif or jpg
    std::optional<std::string> frames;  ///< names with a number, e.g. "pull.%04d"; absent: by the settings
    std::vector<glm::dvec2> at;         ///< where the CoC is told, px; empty: a grid of 3 x 3
    double coc_limit_px = 1;            ///< under which a pixel is in focus, more than 0
    /// Pictures of an earlier run in the same folder are kept where sweep.json says that they were made with
    /// equal settings from an equal file, and they are still as they were written.
    bool resume = false;
    /// What else pictures depend on, e.g. the files named by settings: part of every settings_key.
    std::vector<std::filesystem::path> depends_on;
    Damage damage = Damage::refuse;        ///< what to do about damage in the sample file
    std::optional<double> exposure_stops;  ///< of all pictures; absent: the file's
};

struct SweepWarning {
    FocusWarning worst;        ///< the one with the largest share
    std::size_t pictures = 0;  ///< that have it
};

struct SweepResult {
    SweepTable table;
    std::vector<SweepWarning> warnings;  ///< by code, of the pictures that were made
    std::size_t made = 0, kept = 0;
    std::filesystem::path csv, json;
    std::optional<std::filesystem::path> contact_sheet;  ///< none for more than ContactSheet::most_pictures
};

/// Writes into `folder`, which is made if it is not there: the pictures, sweep.csv, sweep.json, contact.png.
/// Every file appears whole or not at all. sweep.json is brought up to date during the work and when it is
/// interrupted. The pictures are those of PictureMaker. Throws Error(wrong_arguments) for settings out of
/// range before anything is written, Error(cannot_write), and what PictureMaker throws.
[[nodiscard]] SweepResult sweep(const std::filesystem::path& frame, const SweepSettings& settings,
                                const std::filesystem::path& folder);

}  // namespace postlens
