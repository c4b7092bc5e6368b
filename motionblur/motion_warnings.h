// Warnings about effects that moving the recorded surfaces cannot show, with the affected share of the image.
#pragma once

#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "motionblur/motion_blur.h"

namespace postlens {

/// Whether the scene may have effects that moving the recorded surfaces cannot show: it has mirrors, glass,
/// or lights that move or cast shadows.
[[nodiscard]] bool may_have_unseen_motion(const SampleHeader& header);

/// Warns of effects that moving the recorded surfaces cannot show. `moving`: sorted ids of objects that move
/// on the raster. `bands`: records of the frame's instant. The warnings are:
/// - "reflection": pixels whose mirror or glass shows an object that moves differently from it;
/// - "shadow": pixels whose path to a light may be crossed by an object that moves in the world. The objects'
///   bounding spheres are tested at nine instants, in every fourth pixel along either axis;
/// - "light": pixels that show an object while lights move; their shading is that of one instant.
void warn_of_unseen_motion(const SampleHeader& header, const std::vector<RecordBand>& bands,
                           const std::vector<std::uint32_t>& moving, const Exposure& exposure,
                           std::vector<MotionWarning>& out);

/// Warning "uncovered" for pixels of which more than 1 % of the light is unknown (`unknown`, per pixel). A
/// single view of 128 is below this limit, because its sample may fall into the gap between a leaf of a
/// curved surface and two neighbours of half its size. `text` has one placeholder, for the share of such
/// pixels in per cent.
void warn_of_gaps(const std::vector<float>& unknown, const char* text, std::vector<MotionWarning>& out);

/// Warning "overscan" for objects of `moving` that the border of the recorded area cuts off and whose cut
/// side moves into the frame.
void warn_of_cut(const SampleFileReader& file, const FrameMotion& motion, const IdExtents& extents,
                 const std::vector<std::uint32_t>& moving, const Exposure& exposure,
                 std::vector<MotionWarning>& out);

}  // namespace postlens
