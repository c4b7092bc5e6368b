// A sample file as commands use it: opened for one picture, or kept open for many.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "focus/frame.h"
#include "records/sample_file.h"

namespace postlens {

/// A reader, and the records that pictures of any lens share.
struct OpenFrame {
    /// `many`: as FocusFrame says.
    OpenFrame(const std::string& path, Damage damage, std::optional<double> exposure_stops, bool many)
        : file(path, damage, exposure_stops), frame(file, many) {}
    SampleFileReader file;
    FocusFrame frame;
};

/// Keeps a sample file and its records between pictures. Pictures are made one at a time.
class KeptFrame {
  public:
    KeptFrame(std::string path, Damage damage) : path_(std::move(path)), damage_(damage) {}
    /// Who holds it may use what `at` gives.
    [[nodiscard]] std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }
    /// The file, read at an exposure; opened again where that is another one than before.
    [[nodiscard]] std::shared_ptr<OpenFrame> at(std::optional<double> exposure_stops);

  private:
    std::string path_;
    Damage damage_;
    std::mutex mutex_;
    std::shared_ptr<OpenFrame> open_;
    std::optional<double> stops_;
};

}  // namespace postlens
