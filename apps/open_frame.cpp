#include "apps/open_frame.h"

#include <chrono>

#include "apps/command.h"
#include "core/job.h"

namespace postlens {

std::unique_lock<std::timed_mutex> KeptFrame::lock(const std::shared_ptr<KeptFrame>& kept) {
    if (!kept) return {};
    std::unique_lock lock(kept->mutex_, std::defer_lock);
    constexpr std::chrono::milliseconds between_looks(50);
    while (!lock.try_lock_for(between_looks)) throw_if_interrupted();
    return lock;
}

std::shared_ptr<OpenFrame> KeptFrame::at(std::optional<double> exposure_stops) {
    if (!open_ || stops_ != exposure_stops) {
        open_.reset();  // frees the memory before the file is opened again
        open_ = std::make_shared<OpenFrame>(path_, damage_, exposure_stops, true);
        stops_ = exposure_stops;
    }
    return open_;
}

std::shared_ptr<OpenFrame> open_frame(const std::string& input, const std::shared_ptr<KeptFrame>& kept,
                                      const std::optional<double>& exposure_stops, Damage damage) {
    if (kept) return kept->at(exposure_stops);
    return std::make_shared<OpenFrame>(input, damage, exposure_stops, false);
}

}  // namespace postlens
