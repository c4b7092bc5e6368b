/// @file
/// The lens: the settings that several functions share, and quantities computed for a thin lens.
#pragma once

#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// A lens and its focus. A value that is not given is taken from the sample file or picture, or from the
/// camera of a scene.
struct LensSettings {
    /// Focal length F of the lens in mm, more than 0 (`--focal-length`). Together with the f-number, it
    /// determines the diameter of the aperture. It changes the field of view only if `framing` is "lens".
    std::optional<double> focal_length_mm = {};
    /// F-number n, more than 0 (`--f-number`). The diameter of the aperture is focal length / n. Infinity
    /// means a pinhole.
    std::optional<double> f_number = {};
    /// Focus distance in m, more than 0 (`--focus`): the distance along the optical axis from the lens to the
    /// plane in focus. It may be infinite. A lens cannot focus nearer than its focal length. Therefore, the
    /// distance must be more than the focal length if `framing` is "lens", if `breathing` is true, and in
    /// functions that take no `Frame`.
    std::optional<double> focus_distance_m = {};
    /// Focuses on the surface that the pinhole sees at this position (`--focus-at`). It cannot be combined
    /// with `focus_distance_m`.
    std::optional<Position> focus_at = {};
    /// Whether the focal length F determines the field of view (`--framing`). With "keep", the default, the
    /// field of view is independent of F. With "lens", the film is at the distance F from the lens.
    std::string framing = {};
    /// Whether the field of view changes with the focus distance s, as with a real lens (`--breathing`). If
    /// true, the film is at the image distance V = F s / (s - F), where F is the focal length [Potmesil &
    /// Chakravarty 1981, eq. 1].
    bool breathing = false;
    /// The image of a point that is out of focus (`--impulse`): "disc" (default),
    /// "polygon:BLADES[:DEG[:ROUNDNESS]]", "diffraction[:NM[,NM...]]", "image:FILE" or "lens:PRESCRIPTION".
    std::string impulse = {};
    /// Height of the aperture divided by its width, from 0.1 to 10 (`--squeeze`).
    std::optional<double> squeeze = {};
    /// Mechanical vignetting (`--cats-eye`), from 0 to 1.5. Away from the centre of the picture, a second
    /// circle cuts off part of the aperture. The value is the displacement of this circle at the corner of
    /// the picture, in lens radii.
    std::optional<double> cats_eye = {};
    /// Spherical aberration (`--spherical`): difference in focus between the edge and the centre of the lens,
    /// in dioptres from -10 to 10. It is positive if the edge focuses nearer.
    std::optional<double> spherical = {};
};

/// The film on which a circle of confusion is measured.
struct FilmSettings {
    /// Width of a pixel in µm, more than 0 (`--pixel-pitch`). The default is 36 mm / 1920.
    std::optional<double> pixel_pitch_um = {};
    /// Largest diameter of a circle of confusion that still counts as sharp, in mm, more than 0
    /// (`--coc-limit`).
    std::optional<double> coc_limit_mm = {};
};

/// The circle of confusion: the disc on the film into which a lens spreads the light of one point.
struct CircleOfConfusion {
    double coc_mm = 0;   ///< Diameter in mm, positive behind the focus and negative in front of it.
    double coc_px = 0;   ///< The same diameter in pixels of the film.
    Report report = {};  ///< Report of `postlens lens coc`.
};

/// The range of depths that appear sharp through a lens.
struct DepthOfField {
    double near_m = 0;        ///< Nearest sharp depth, m.
    double far_m = 0;         ///< Farthest sharp depth, m. It may be infinite.
    double hyperfocal_m = 0;  ///< The nearest focus distance, m, for which `far_m` is infinite.
    Report report = {};       ///< Report of `postlens lens dof`.
};

/// Returns the circle of confusion of a point. The film is at the distance V = F s / (s - F) from the lens,
/// where F is the focal length and s the focus distance [Potmesil & Chakravarty 1981, eq. 3]. Throws
/// Error(wrong_arguments) if a value is out of range.
/// @param lens Focal length, f-number and focus distance, which are all required. Other members must not be
/// set.
/// @param depth_m Depth of the point along the optical axis, in m, more than 0. It may be infinite.
/// @param film The film.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The circle of confusion.
[[nodiscard]] CircleOfConfusion circle_of_confusion(const LensSettings& lens, double depth_m,
                                                    const FilmSettings& film = {}, Job* job = nullptr);

/// Returns the range of depths whose circle of confusion is at most `coc_limit_mm`. Throws
/// Error(wrong_arguments) if a value is out of range.
/// @param lens As for `circle_of_confusion`.
/// @param film The film, and `coc_limit_mm`, the largest circle of confusion that counts as sharp.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The depth of field.
[[nodiscard]] DepthOfField depth_of_field(const LensSettings& lens, const FilmSettings& film = {},
                                          Job* job = nullptr);

/// Settings of `impulse_response`.
struct ResponseSettings {
    /// The lens whose impulse response is computed. Its focal length, f-number and focus distance are
    /// required. `focus_at`, `framing`, `breathing`, `cats_eye` and lens prescriptions must not be set.
    LensSettings lens = {};
    /// Depth of the point in m, more than 0 (`--depth`). It is required.
    std::optional<double> depth_m = {};
    /// Wavelength in nm, from 100 to 20000 (`--wavelength`). Default: 550 nm.
    std::optional<double> wavelength_nm = {};
    /// Width of a pixel in µm, more than 0 (`--pixel-pitch`).
    std::optional<double> pixel_pitch_um = {};
    /// Width and height of the computed impulse response (the image of a point), in px (`--size`). By
    /// default, they are large enough to contain 99 % of the light's energy, but at most 1025 px.
    std::optional<int> size_px = {};
    /// Further options of `postlens lens psf`, for example {"--profile=FILE.csv"}.
    std::vector<std::string> options = {};
};

/// The impulse response of a lens (point spread function): the image of one point on the film.
struct ImpulseResponse {
    int width = 0;   ///< px.
    int height = 0;  ///< px.
    /// Fraction of the point's light energy that falls into each pixel, by rows from the top, width * height
    /// values. Their sum is less than 1 if some light falls outside these pixels.
    std::vector<float> values = {};
    double energy_in_frame = 0;    ///< Sum of `values`, up to 1.
    double coc_px = 0;             ///< Diameter of the geometric circle of confusion, px.
    double image_distance_mm = 0;  ///< Distance V = F s / (s - F) from the lens to the film, mm.
    Report report = {};            ///< Report of `postlens lens psf`.
};

/// Computes the impulse response of a lens for a point on the optical axis. Throws Error(wrong_arguments) if
/// a value is out of range.
/// @param settings Lens, point, wavelength and raster.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The impulse response.
[[nodiscard]] ImpulseResponse impulse_response(const ResponseSettings& settings, Job* job = nullptr);

}  // namespace postlens::api
