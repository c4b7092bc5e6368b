// What moving the recorded surfaces cannot show: how much of the picture it concerns.
#pragma once

#include <vector>

#include "motionblur/band_surfaces.h"
#include "motionblur/motion_blur.h"

namespace postlens {

/// Whether there is anything to warn of: mirrors or glass, or lights that move or cast shadows.
[[nodiscard]] bool may_have_unseen_motion(const SampleHeader& header);

/// `moving`: ids that do not stand still on the raster, sorted. `bands`: the records of the frame's instant.
/// - "reflection": pixels whose mirror or glass shows what moves otherwise than the mirror does;
/// - "shadow": pixels from which the way to a light may be crossed by something that moves in the world: by
/// the
///   spheres around the objects, at nine instants, from every fourth pixel;
/// - "light": lights move, so that the shading is that of one instant.
void warn_of_unseen_motion(const SampleHeader& header, const std::vector<RecordBand>& bands,
                           const std::vector<std::uint32_t>& moving, const Exposure& exposure,
                           std::vector<MotionWarning>& out);

/// "uncovered": pixels of which more than a hundredth of the light is unknown (`unknown`, by pixel). One view
/// of 128 is not worth a warning: where a leaf of a curved surface meets two of half its size, a look may
/// fall between them. `text` has one place for the share in per cent.
void warn_of_gaps(const std::vector<float>& unknown, const char* text, std::vector<MotionWarning>& out);

/// "overscan": ids of `moving` that the border of the records cuts, and that come into the frame there.
void warn_of_cut(const SampleFileReader& file, const FrameMotion& motion, const IdExtents& extents,
                 const std::vector<std::uint32_t>& moving, const Exposure& exposure,
                 std::vector<MotionWarning>& out);

}  // namespace postlens
