// An open sample file, from which one image or many images are made.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "focus/frame.h"
#include "records/sample_file.h"

namespace postlens {

/// The reader of a sample file, and the frame that it reads.
struct OpenFrame {
    /// `many`: keep the records in memory for further images (FocusFrame).
    OpenFrame(const std::string& path, Damage damage, std::optional<double> exposure_stops, bool many)
        : file(path, damage, exposure_stops), frame(file, many) {}
    SampleFileReader file;
    FocusFrame frame;
};

/// Keeps a sample file and its records open between images. Only one image can be made at a time.
class KeptFrame {
  public:
    KeptFrame(std::string path, Damage damage) : path_(std::move(path)), damage_(damage) {}
    /// A caller must hold this lock while it uses the result of `at`. Waits until no other caller holds it.
    /// Throws Error(interrupted) if the current job is cancelled meanwhile. Locks nothing if `kept` is null.
    [[nodiscard]] static std::unique_lock<std::timed_mutex> lock(const std::shared_ptr<KeptFrame>& kept);
    /// Returns the file, read at the given exposure. Opens the file again if the last call had another
    /// exposure.
    [[nodiscard]] std::shared_ptr<OpenFrame> at(std::optional<double> exposure_stops);

  private:
    std::string path_;
    Damage damage_;
    std::timed_mutex mutex_;
    std::shared_ptr<OpenFrame> open_;
    std::optional<double> stops_;
};

}  // namespace postlens
