// An open sample file, from which one or more images are made.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "focus/frame.h"
#include "records/sample_file.h"

namespace postlens {

/// The reader of a sample file, and the frame that uses this reader.
struct OpenFrame {
    /// Opens the file. With `many`, the records stay in memory for further images (FocusFrame).
    OpenFrame(const std::string& path, Damage damage, std::optional<double> exposure_stops, bool many)
        : file(path, damage, exposure_stops), frame(file, many) {}
    SampleFileReader file;
    FocusFrame frame;
};

/// Keeps a sample file and its records open, so that further images need not read them again. Only one image
/// can be made at a time.
class KeptFrame {
  public:
    KeptFrame(std::string path, Damage damage) : path_(std::move(path)), damage_(damage) {}
    /// Returns a lock that the caller must hold while it uses the result of `at`. Waits until the lock is
    /// free. Throws Error(interrupted) if the current job is cancelled meanwhile. If `kept` is null, the
    /// result locks nothing.
    [[nodiscard]] static std::unique_lock<std::timed_mutex> lock(const std::shared_ptr<KeptFrame>& kept);
    /// Returns the file, read at the given exposure. If the last call had another exposure, the file is
    /// opened again.
    [[nodiscard]] std::shared_ptr<OpenFrame> at(std::optional<double> exposure_stops);

  private:
    std::string path_;
    Damage damage_;
    std::timed_mutex mutex_;
    std::shared_ptr<OpenFrame> open_;
    std::optional<double> stops_;
};

}  // namespace postlens
