// Warns about effects that moved records cannot show.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "motionblur/motion_blur.h"

namespace postlens {

/// Finds effects that motion blur cannot show if it only displaces the recorded surfaces. warnings() names
/// them:
/// - "reflection": a mirror or glass shows an object that moves differently from it
/// - "shadow": a moving object may block the light (its bounding sphere is tested)
/// - "light": shading changes, because a light moves, or because the direction from an object to a light
///   changes by over 15 degrees relative to the object
///
/// If possible() returns true, call add() for all pixel rows of the frame, and then warnings().
class UnseenMotion {
  public:
    /// `moving`: sorted ids of all moving objects. add() searches for these objects in mirrors and glass. The
    /// motion of lights and of objects that cast shadows is read from `header`, which must outlive this
    /// object.
    UnseenMotion(const SampleHeader& header, std::vector<std::uint32_t> moving, const Exposure& exposure);
    ~UnseenMotion();
    UnseenMotion(const UnseenMotion&) = delete;
    UnseenMotion& operator=(const UnseenMotion&) = delete;
    UnseenMotion(UnseenMotion&&) = delete;
    UnseenMotion& operator=(UnseenMotion&&) = delete;

    /// Returns false if the motion cannot change shadows, reflections or shading.
    [[nodiscard]] bool possible() const;
    /// Tests the surfaces recorded in pixel rows [y_begin, y_end) of `band`.
    void add(const RecordBand& band, int y_begin, int y_end);
    [[nodiscard]] std::vector<MotionWarning> warnings() const;

  private:
    struct Counts;
    std::unique_ptr<Counts> counts_;
};

/// Adds the warning "uncovered" if moving objects uncover surfaces that are not recorded. `unknown` is the
/// fraction of each pixel's light that comes from such surfaces. `text` is a format string for the percentage
/// of pixels in which this fraction is above 1 %.
void warn_of_gaps(const std::vector<float>& unknown, const char* text, std::vector<MotionWarning>& out);

/// Returns whether a part of the object `id` is missing at some time of the exposure, because it lies outside
/// the traced area at the recorded instants.
/// - `instants`: bounding boxes of all objects at each recorded instant from which the image is made; the
///   first is the frame's own instant
[[nodiscard]] bool is_cut(const SampleFileReader& file, const FrameMotion& motion, std::uint32_t id,
                          std::span<const IdExtents> instants, const Exposure& exposure);

/// Adds the warning "overscan" if the border of the traced area cuts off moving objects.
void warn_of_cut(const SampleFileReader& file, const FrameMotion& motion,
                 const std::vector<ObjectReport>& objects, std::span<const IdExtents> instants,
                 const Exposure& exposure, std::vector<MotionWarning>& out);

}  // namespace postlens
