// Which impulse response is asked for: what a point of light out of focus becomes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace postlens {

enum class ImpulseKind {
    disc,         ///< a round aperture, evenly lit
    polygon,      ///< blades
    picture,      ///< the aperture's transmission from a picture
    diffraction,  ///< a round aperture, by waves
    lens,         ///< a real lens from its prescription
};

/// Names are those of `--impulse`, `--squeeze`, `--cats-eye` and `--spherical`.
struct Impulse {
    ImpulseKind kind = ImpulseKind::disc;
    int blades = 6;                      ///< 3..64; of a polygon
    double rotation_deg = 0;             ///< of a corner, from the picture's right towards its bottom
    double roundness = 0;                ///< 0 straight sides .. 1 a circle
    std::vector<double> wavelengths_nm;  ///< of diffraction; empty: a few for each colour channel
    std::filesystem::path file;          ///< of a picture or a lens

    // For disc, polygon and picture:
    double squeeze = 1;    ///< > 0: the aperture is so many times as tall as wide, its height kept
    double cats_eye = 0;   ///< >= 0, see Aperture
    double spherical = 0;  ///< 1/m, see Aperture
};

/// disc | polygon:BLADES[:DEG[:ROUNDNESS]] | diffraction[:NM[,NM...]] | image:FILE | lens:PRESCRIPTION.
/// Throws Error(wrong_arguments) that begins with `option`.
[[nodiscard]] Impulse parse_impulse(const std::string& option, const std::string& text);

/// Throws Error(wrong_arguments) for modifiers out of range, or that the kind does not take.
void check_impulse(const Impulse& impulse);

/// As it would be written after `--impulse`.
[[nodiscard]] std::string impulse_text(const Impulse& impulse);

}  // namespace postlens
