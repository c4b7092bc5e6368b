// Warnings about effects that cannot be shown by moving the recorded surfaces, with the share of the image
// that is affected.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "motionblur/motion_blur.h"

namespace postlens {

/// Effects that cannot be shown by moving the recorded surfaces of one instant. The warnings are:
/// - "reflection": pixels whose mirror or glass shows an object that moves differently from the mirror or
///   glass;
/// - "shadow": pixels whose path to a light may be crossed by an object that moves in the world. The objects'
///   bounding spheres are tested at the frame's instant and nine of the exposure, in every fourth pixel
///   along each axis;
/// - "light": pixels whose shading is that of one instant although it should change. Either lights move, or
///   the pixel shows an object from which the direction to a light changes by more than 15 degrees, because
///   the object turns or passes by the light.
///
/// Usage: if `possible`, add all rows of the frame; then get the warnings.
class UnseenMotion {
  public:
    /// `moving`: sorted ids of objects that move on the raster. `header` must exist as long as this object.
    UnseenMotion(const SampleHeader& header, std::vector<std::uint32_t> moving, const Exposure& exposure);
    ~UnseenMotion();
    UnseenMotion(const UnseenMotion&) = delete;
    UnseenMotion& operator=(const UnseenMotion&) = delete;
    UnseenMotion(UnseenMotion&&) = delete;
    UnseenMotion& operator=(UnseenMotion&&) = delete;

    [[nodiscard]] bool possible() const;
    /// Adds the records of rows [y_begin, y_end) of `band`.
    void add(const RecordBand& band, int y_begin, int y_end);
    [[nodiscard]] std::vector<MotionWarning> warnings() const;

  private:
    struct Counts;
    std::unique_ptr<Counts> counts_;
};

/// Adds the warning "uncovered" for pixels with more than 1 % unknown light (`unknown`, per pixel). The limit
/// exceeds one of 128 views, because a view's sample may fall into the gap between a quadtree leaf of a
/// curved surface and two neighbours of half its size. `text` has one placeholder, for the share of the
/// affected pixels in per cent.
void warn_of_gaps(const std::vector<float>& unknown, const char* text, std::vector<MotionWarning>& out);

/// Whether the border of the recorded area cuts off an object so that a part of it is missing in the frame
/// while the shutter is open. `instants`: extents of the objects at the first recorded instants of the file,
/// which are the ones to use. At every instant of the exposure, one of the two recorded instants around it
/// suffices if it shows the whole object.
[[nodiscard]] bool is_cut(const SampleFileReader& file, const FrameMotion& motion, std::uint32_t id,
                          std::span<const IdExtents> instants, const Exposure& exposure);

/// Adds the warning "overscan" for those moving objects that are cut off (`is_cut`). lightfield uses all
/// recorded instants of `instants`, convolve the first. If the camera moves, only those made by convolve.
void warn_of_cut(const SampleFileReader& file, const FrameMotion& motion,
                 const std::vector<ObjectReport>& objects, std::span<const IdExtents> instants,
                 const Exposure& exposure, std::vector<MotionWarning>& out);

}  // namespace postlens
