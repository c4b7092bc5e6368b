// The focus processor: a sample file and a lens in, the picture that the lens would take out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lens/focus_geometry.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

enum class FocusMethod { pinhole, scatter };
enum class DepthSpacing {
    linear,   ///< equal steps in z', as in 1981
    inverse,  ///< equal steps in 1/z', that is, equal steps of CoC
};
enum class DepthModel {
    ray_differentials,  ///< W of each node: what mirrors and glass show keeps its own optical depth
    path,               ///< z' of each node: the path length of 1981
    first_hit,          ///< z' of the primary node for all nodes of its sample: what tools without trees do
};

struct FocusSettings {
    ThinLens lens;  ///< f_number infinity: pinhole
    double focus_distance_m = 1;
    Framing framing = Framing::keep;
    FocusMethod method = FocusMethod::scatter;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    /// Number of impulse responses over the finite depths, >= 2. Absent: chosen so that the CoC's diameter is
    /// quantised by less than half a pixel.
    std::optional<int> depths;
};

struct FocusWarning {
    std::string code;
    double share = 0;  ///< of the pixels concerned
    std::string text;
};

struct FocusResult {
    Image image;
    FocusMethod method = FocusMethod::scatter;  ///< what was used: `pinhole` for a zero aperture
    int depths = 0;                             ///< impulse responses used; 0 for pinhole
    double largest_coc_px = 0;                  ///< greatest diameter among the records
    std::vector<FocusWarning> warnings;
};

/// The picture. Deterministic: the same bits for any number of threads.
/// Throws Error(wrong_arguments) for settings out of range and for an orthographic file with a finite f-number,
/// Error(invalid_input) for a damaged file.
[[nodiscard]] FocusResult focus_picture(const SampleFileReader& file, const FocusSettings& settings);

/// The pinhole picture from the records alone; bit for bit part 0 of the file.
[[nodiscard]] Image pinhole_picture(const SampleFileReader& file);

}  // namespace postlens
