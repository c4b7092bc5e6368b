// Settings of the impulse response, the image of one scene point.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace postlens {

enum class ImpulseKind {
    disc,         ///< a round aperture, uniformly lit
    polygon,      ///< aperture of straight or curved blades
    picture,      ///< aperture whose transmission is read from an image
    diffraction,  ///< a round aperture, by wave optics
    lens,         ///< a real lens, traced from its prescription
};

/// Limits of accepted wavelengths, nm.
inline constexpr double shortest_wavelength_nm = 100, longest_wavelength_nm = 1e5;

/// Settings of the options `--impulse`, `--squeeze`, `--cats-eye` and `--spherical`.
struct Impulse {
    ImpulseKind kind = ImpulseKind::disc;
    int blades = 6;                      ///< 3..64; of a polygon
    double rotation_deg = 0;             ///< of a corner, from right towards down
    double roundness = 0;                ///< 0: straight sides .. 1: a circle
    std::vector<double> wavelengths_nm;  ///< for diffraction; if empty, several per channel
    std::filesystem::path file;          ///< for picture and lens

    // The following values apply to apertures that are a disc, a polygon or an image.
    double squeeze = 1;    ///< > 0; height / width of the aperture; the height is fixed
    double cats_eye = 0;   ///< >= 0, see Aperture
    double spherical = 0;  ///< 1/m, see Aperture
};

/// Parses the argument of the option that selects the impulse response. The argument has one of these forms:
/// disc | polygon:BLADES[:DEG[:ROUNDNESS]] | diffraction[:NM[,NM...]] | image:FILE | lens:PRESCRIPTION. The
/// form lens is accepted only if `real_lenses` is true.
///
/// Throws Error(wrong_arguments) with a message that begins with `option`, the name of the option.
[[nodiscard]] Impulse parse_impulse(const std::string& option, const std::string& text,
                                    bool real_lenses = true);

/// Returns the file name in the argument `text` of `--impulse` (image:FILE or lens:FILE), or an empty string
/// if it names no file.
[[nodiscard]] std::string file_of_impulse(const std::string& text);

/// Throws Error(wrong_arguments) if squeeze, cats_eye or spherical (see Aperture) is out of range, or does
/// not apply to impulse.kind.
void check_impulse(const Impulse& impulse);

/// Formats the settings as the argument of `--impulse`.
[[nodiscard]] std::string impulse_text(const Impulse& impulse);

}  // namespace postlens
