// An open sample file, from which one or more images are made.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "focus/frame.h"
#include "records/sample_file.h"

namespace postlens {

struct OpenFrame {
    /// Opens the sample file `path`. If `many` is true, all records are kept in memory, so that many images
    /// can be made quickly.
    OpenFrame(const std::string& path, Damage damage, std::optional<double> exposure_stops, bool many)
        : file(path, damage, exposure_stops), frame(file, many) {}
    SampleFileReader file;
    FocusFrame frame;
};

/// Keeps a sample file open and its records in memory, so that further images are made faster. Makes only one
/// image at a time.
class KeptFrame {
  public:
    KeptFrame(std::string path, Damage damage) : path_(std::move(path)), damage_(damage) {}
    /// Locks `kept`, an open sample file, and returns the lock. The caller must hold the lock while it uses
    /// the file. Waits if another caller holds it. If `kept` is null, the returned lock is empty. Throws
    /// Error(interrupted) if the current job is cancelled.
    [[nodiscard]] static std::unique_lock<std::timed_mutex> lock(const std::shared_ptr<KeptFrame>& kept);
    /// Returns the open sample file, with its radiance scaled by the given exposure, in stops. The radiance
    /// is scaled while the file is read. So if the exposure is not that of the last call, the file is opened
    /// and read again.
    [[nodiscard]] std::shared_ptr<OpenFrame> at(std::optional<double> exposure_stops);

  private:
    std::string path_;
    Damage damage_;
    std::timed_mutex mutex_;
    std::shared_ptr<OpenFrame> open_;
    std::optional<double> stops_;
};

}  // namespace postlens
