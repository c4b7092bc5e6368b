/// @file
/// The lens: the settings that several functions share, and quantities computed for a thin lens.
#pragma once

#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// A lens and its focus. A value that is not given is taken from the file or from the scene's camera.
struct LensSettings {
    /// Focal length F, mm, more than 0 (`--focal-length`). It determines the width of the aperture. The field
    /// of view is that of the trace, unless `framing` changes it.
    std::optional<double> focal_length_mm = {};
    /// F-number n, more than 0: the aperture's diameter is F / n (`--f-number`). Infinity: a pinhole.
    std::optional<double> f_number = {};
    /// Distance from the lens to the plane in focus, m, along the optical axis, more than 0 (`--focus`). It
    /// must be more than F if the film is at the distance F or V (`framing`, `breathing`, or a function for a
    /// single lens). Infinity is allowed.
    std::optional<double> focus_distance_m = {};
    /// Focuses on the surface that the pinhole sees at this position (`--focus-at`). Cannot be combined with
    /// `focus_distance_m`.
    std::optional<Position> focus_at = {};
    /// Effect of F on the field of view (`--framing`). "keep" (default): none. "lens": the film is at the
    /// distance F.
    std::string framing = {};
    /// Puts the film at the image distance V = F s / (s - F), where s is the focus distance. The field of
    /// view then changes with s (`--breathing`) [Potmesil & Chakravarty 1981, eq. 1].
    bool breathing = false;
    /// The image of a point that is out of focus (`--impulse`): "disc" (default),
    /// "polygon:BLADES[:DEG[:ROUNDNESS]]", "diffraction[:NM[,NM...]]", "image:FILE" or "lens:PRESCRIPTION".
    std::string impulse = {};
    /// Height of the aperture divided by its width, 0.1 to 10 (`--squeeze`).
    std::optional<double> squeeze = {};
    /// Mechanical vignetting (`--cats-eye`): displacement of a second rim at the corner of the picture, in
    /// radii of the lens, 0 to 1.5.
    std::optional<double> cats_eye = {};
    /// Spherical aberration (`--spherical`): difference in focus between the rim of the lens and its middle,
    /// dioptres, -10 to 10. Positive if the rim focuses nearer.
    std::optional<double> spherical = {};
};

/// The film on which a circle of confusion is measured.
struct FilmSettings {
    /// Width of a pixel, µm, more than 0 (`--pixel-pitch`). Default: 36 mm over 1920 px.
    std::optional<double> pixel_pitch_um = {};
    /// Largest diameter of a circle of confusion that counts as sharp, mm, more than 0 (`--coc-limit`).
    std::optional<double> coc_limit_mm = {};
};

/// The circle of confusion: the disc on the film into which a lens spreads the light of one point.
struct CircleOfConfusion {
    double coc_mm = 0;   ///< Diameter, mm: positive behind the focus, negative in front of it.
    double coc_px = 0;   ///< The same diameter in pixels of the film.
    Report report = {};  ///< Of `postlens lens coc`.
};

/// The range of depths that appear sharp through a lens.
struct DepthOfField {
    double near_m = 0;        ///< Nearest sharp depth, m.
    double far_m = 0;         ///< Farthest sharp depth, m; may be infinite.
    double hyperfocal_m = 0;  ///< The nearest focus distance, m, for which `far_m` is infinite.
    Report report = {};       ///< Of `postlens lens dof`.
};

/// Returns the circle of confusion of a point. The film is at the distance V = F s / (s - F) from the lens,
/// for the focal length F and the focus distance s [Potmesil & Chakravarty 1981, eq. 3]. Throws
/// Error(wrong_arguments).
/// @param lens Focal length, f-number and focus distance, all required. Other members are ignored.
/// @param depth_m Depth of the point along the optical axis, m, more than 0; may be infinite.
/// @param film The film.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The circle of confusion.
[[nodiscard]] CircleOfConfusion circle_of_confusion(const LensSettings& lens, double depth_m,
                                                    const FilmSettings& film = {}, Job* job = nullptr);

/// Returns the range of depths whose circle of confusion is at most `coc_limit_mm`. Throws
/// Error(wrong_arguments).
/// @param lens As for `circle_of_confusion`.
/// @param film The film, with the largest circle of confusion that counts as sharp.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The depth of field.
[[nodiscard]] DepthOfField depth_of_field(const LensSettings& lens, const FilmSettings& film = {},
                                          Job* job = nullptr);

/// Settings of `impulse_response`.
struct ResponseSettings {
    /// Lens and focus distance, all required. `focus_at`, `framing`, `breathing` and lens prescriptions are
    /// ignored.
    LensSettings lens = {};
    /// Depth of the point, m, more than 0 (`--depth`); required.
    std::optional<double> depth_m = {};
    /// Wavelength, nm, 100 to 20000 (`--wavelength`). Default: 550 nm.
    std::optional<double> wavelength_nm = {};
    /// Width of a pixel, µm, more than 0 (`--pixel-pitch`).
    std::optional<double> pixel_pitch_um = {};
    /// Width and height of the response, px (`--size`). Default: large enough for 99 % of the energy, at most
    /// 1025 px.
    std::optional<int> size_px = {};
    /// Further options of `postlens lens psf`, for example {"--profile=FILE.csv"}.
    std::vector<std::string> options = {};
};

/// The impulse response of a lens (point spread function): the image of one point on the film.
struct ImpulseResponse {
    int width = 0;   ///< px.
    int height = 0;  ///< px.
    /// Fraction of the point's energy in each pixel, rows from the top, width * height values. The sum over
    /// all pixels of the film, including those beyond this raster, is 1.
    std::vector<float> values = {};
    double energy_in_frame = 0;    ///< Sum of `values`, up to 1.
    double coc_px = 0;             ///< Diameter of the geometric circle of confusion, px.
    double image_distance_mm = 0;  ///< Distance V = F s / (s - F) from the lens to the film, mm.
    Report report = {};            ///< Of `postlens lens psf`.
};

/// Computes the impulse response of a lens for a point on the optical axis. Throws Error(wrong_arguments).
/// @param settings Lens, point, wavelength and raster.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The impulse response.
[[nodiscard]] ImpulseResponse impulse_response(const ResponseSettings& settings, Job* job = nullptr);

}  // namespace postlens::api
