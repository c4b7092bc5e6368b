// Warnings about effects that cannot be shown by moving the recorded surfaces, with the share of the image
// that is affected.
#pragma once

#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "motionblur/motion_blur.h"

namespace postlens {

/// Whether the scene may have effects that cannot be shown by moving the recorded surfaces. These are
/// mirrors, glass, and lights that move or cast shadows.
[[nodiscard]] bool may_have_unseen_motion(const SampleHeader& header);

/// Warns of effects that cannot be shown by moving the recorded surfaces. `moving`: sorted ids of objects
/// that move on the raster. `bands`: records of the frame's instant. The warnings are:
/// - "reflection": pixels whose mirror or glass shows an object that moves differently from the mirror or
///   glass;
/// - "shadow": pixels whose path to a light may be crossed by an object that moves in the world. The objects'
///   bounding spheres are tested at nine instants, in every fourth pixel along each axis;
/// - "light": pixels that show an object while lights move; their shading is that of one instant.
void warn_of_unseen_motion(const SampleHeader& header, const std::vector<RecordBand>& bands,
                           const std::vector<std::uint32_t>& moving, const Exposure& exposure,
                           std::vector<MotionWarning>& out);

/// Adds the warning "uncovered" for pixels with more than 1 % unknown light (`unknown`, per pixel). The limit
/// exceeds one of 128 views, because a view's sample may fall into the gap between a quadtree leaf of a
/// curved surface and two neighbours of half its size. `text` has one placeholder, for the share of the
/// affected pixels in per cent.
void warn_of_gaps(const std::vector<float>& unknown, const char* text, std::vector<MotionWarning>& out);

/// Adds the warning "overscan" for those objects of `moving` that the border of the recorded area cuts off
/// and whose cut side moves into the frame.
void warn_of_cut(const SampleFileReader& file, const FrameMotion& motion, const IdExtents& extents,
                 const std::vector<std::uint32_t>& moving, const Exposure& exposure,
                 std::vector<MotionWarning>& out);

}  // namespace postlens
