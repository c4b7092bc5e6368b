// An open sample file, for one image or kept open for many.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "focus/frame.h"
#include "records/sample_file.h"

namespace postlens {

/// The reader of a sample file, and its frame.
struct OpenFrame {
    /// `many`: keeps the records in memory for further images (FocusFrame).
    OpenFrame(const std::string& path, Damage damage, std::optional<double> exposure_stops, bool many)
        : file(path, damage, exposure_stops), frame(file, many) {}
    SampleFileReader file;
    FocusFrame frame;
};

/// Keeps a sample file and its records open between images. Only one image is made at a time.
class KeptFrame {
  public:
    KeptFrame(std::string path, Damage damage) : path_(std::move(path)), damage_(damage) {}
    /// A caller must hold this lock while it uses the result of `at`.
    [[nodiscard]] std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }
    /// The file, read at the given exposure. It is opened again if the exposure differs from the last one.
    [[nodiscard]] std::shared_ptr<OpenFrame> at(std::optional<double> exposure_stops);

  private:
    std::string path_;
    Damage damage_;
    std::mutex mutex_;
    std::shared_ptr<OpenFrame> open_;
    std::optional<double> stops_;
};

}  // namespace postlens
