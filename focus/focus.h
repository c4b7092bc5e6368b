// The focus processor: a sample file and a lens in, the picture that the lens would take out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "focus/depth_levels.h"
#include "focus/frame.h"
#include "focus/lens_views.h"
#include "lens/focus_geometry.h"
#include "lens/impulse.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

/// `hybrid` is planner/hybrid.h's, `automatic` planner/auto_picture.h's.
enum class FocusMethod { pinhole, scatter, layers, lightfield, hybrid, automatic };

struct FocusSettings {
    ThinLens lens;  ///< f_number infinity: pinhole; an `impulse` of a real lens has a focal length of its own
    double focus_distance_m = 1;
    Framing framing = Framing::keep;
    FocusMethod method = FocusMethod::scatter;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    Impulse impulse;
    /// Number of impulse responses over the finite depths, 2..DepthLevels::most_depths. Absent: chosen so
    /// that the CoC's diameter is quantised by less than half a pixel (see DepthLevels).
    std::optional<int> depths;
    /// Points of the lens that `lightfield` looks from, 1..most_lens_views.
    int views = default_lens_views;
    /// What of the picture is wanted; the rest of the image is black or anything. These pixels have the same
    /// bits as without; warnings tell of them alone.
    std::optional<Crop> crop;
    /// What the splats of `scatter` and `layers` may take; where they might take more, the picture is made in
    /// strips whose splats take a third of it or less, for each of which what reaches it is read again. The
    /// same bits.
    std::size_t splat_bytes = std::size_t{672} << 20;
};

struct FocusWarning {
    std::string code;  ///< "overscan": the records end before what the border needs; "uncovered": nothing was
                       ///< recorded of what the lens sees
    double share = 0;  ///< of the pixels concerned
    std::string text;
};

struct FocusResult {
    Image image;
    FocusMethod method = FocusMethod::scatter;  ///< what was used: `pinhole` for a zero aperture
    /// Impulse responses: as many as were asked for, else discs of different radius in use; 0 for pinhole.
    int depths = 0;
    int views = 0;              ///< of `lightfield`
    double largest_coc_px = 0;  ///< greatest diameter among the primary nodes, px of the image
    /// Of the image; absent for an orthographic file.
    std::optional<FocusGeometry> geometry;
    std::vector<FocusWarning> warnings;
};

/// The picture. Deterministic: the same bits for any number of threads.
/// Throws Error(wrong_arguments) for settings out of range, a crop beyond the picture among them, and for an
/// orthographic file with a finite f-number, Error(invalid_input) for a damaged file.
[[nodiscard]] FocusResult focus_picture(FocusFrame& frame, const FocusSettings& settings);
/// One picture of a file.
[[nodiscard]] FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings);

/// The pinhole picture from the records alone; bit for bit part 0 of the file.
[[nodiscard]] Image pinhole_picture(const SampleFileReader& file,
                                    const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
