/// @file
/// The lens: the settings that several functions share, and the figures of a thin lens.
#pragma once

#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// A lens and where it is focused. A value that is not given is that of the file or of the scene's camera.
struct LensSettings {
    /// Focal length F, mm, more than 0 (`--focal-length`). It sets the width of the aperture; the field of
    /// view stays that of the trace unless `framing` says otherwise.
    std::optional<double> focal_length_mm = {};
    /// F-number n, more than 0: the aperture's diameter is F / n (`--f-number`). Infinity: a pinhole.
    std::optional<double> f_number = {};
    /// Distance from the lens to the plane in focus, m, along the optical axis, more than F (`--focus`).
    /// Infinity is allowed.
    std::optional<double> focus_distance_m = {};
    /// Focuses on the surface that the pinhole sees at this position (`--focus-at`). Not together with
    /// `focus_distance_m`.
    std::optional<Position> focus_at = {};
    /// What F does to the field of view (`--framing`): "keep" (default): nothing; "lens": the film is at F.
    std::string framing = {};
    /// Puts the film at V = F s / (s - F) for the focus distance s, so that the field of view changes with s
    /// (`--breathing`) [Potmesil & Chakravarty 1981, eq. 1].
    bool breathing = false;
    /// The image of a point out of focus (`--impulse`): "disc" (default), "polygon:BLADES[:DEG[:ROUNDNESS]]",
    /// "diffraction[:NM[,NM...]]", "image:FILE" or "lens:PRESCRIPTION".
    std::string impulse = {};
    /// Height of the aperture divided by its width, 0.1 to 10 (`--squeeze`).
    std::optional<double> squeeze = {};
    /// Mechanical vignetting (`--cats-eye`): shift of a second rim at the picture's corner, in radii of the
    /// lens, 0 to 1.5.
    std::optional<double> cats_eye = {};
    /// Spherical aberration (`--spherical`): how much nearer the rim of the lens focuses than its middle,
    /// dioptres, -10 to 10.
    std::optional<double> spherical = {};
};

/// The film on which a circle of confusion is measured.
struct FilmSettings {
    /// Width of a pixel, µm, more than 0 (`--pixel-pitch`). Default: 36 mm over 1920 px.
    std::optional<double> pixel_pitch_um = {};
    /// Widest circle of confusion that counts as sharp, mm, more than 0 (`--coc-limit`).
    std::optional<double> coc_limit_mm = {};
};

/// The circle of confusion: the disc on the film into which a lens spreads the light of one point.
struct CircleOfConfusion {
    double coc_mm = 0;   ///< Diameter, mm: positive behind the focus, negative in front of it.
    double coc_px = 0;   ///< The same in pixels of the film.
    Report report = {};  ///< Of `postlens lens coc`.
};

/// The range of depths that a lens shows sharp.
struct DepthOfField {
    double near_m = 0;        ///< Nearest sharp depth, m.
    double far_m = 0;         ///< Farthest sharp depth, m; may be infinite.
    double hyperfocal_m = 0;  ///< The nearest focus distance with an infinite `far_m`, m.
    Report report = {};       ///< Of `postlens lens dof`.
};

/// The circle of confusion of a point on a film at V [Potmesil & Chakravarty 1981, eq. 3]. Throws
/// Error(wrong_arguments).
/// @param lens Focal length, f-number and focus distance, all required; nothing else applies.
/// @param depth_m Depth of the point along the optical axis, m, more than 0; may be infinite.
/// @param film The film.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The circle of confusion.
[[nodiscard]] CircleOfConfusion circle_of_confusion(const LensSettings& lens, double depth_m,
                                                    const FilmSettings& film = {}, Job* job = nullptr);

/// The depths whose circle of confusion is at most `coc_limit_mm`. Throws Error(wrong_arguments).
/// @param lens As for `circle_of_confusion`.
/// @param film The film, which says what counts as sharp.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The depth of field.
[[nodiscard]] DepthOfField depth_of_field(const LensSettings& lens, const FilmSettings& film = {},
                                          Job* job = nullptr);

/// Settings of `impulse_response`.
struct ResponseSettings {
    /// Lens and focus distance, all required. `focus_at`, `framing`, `breathing` and real lenses do not
    /// apply.
    LensSettings lens = {};
    /// Depth of the point, m, more than 0 (`--depth`); required.
    std::optional<double> depth_m = {};
    /// Wavelength, nm, 100 to 20000 (`--wavelength`). Default: 550 nm.
    std::optional<double> wavelength_nm = {};
    /// Width of a pixel, µm, more than 0 (`--pixel-pitch`).
    std::optional<double> pixel_pitch_um = {};
    /// Width and height of the response, px (`--size`). Default: what holds 99 % of the energy, at most 1025
    /// px.
    std::optional<int> size_px = {};
    /// Further options of `postlens lens psf`, for example {"--profile=FILE.csv"}.
    std::vector<std::string> options = {};
};

/// The impulse response of a lens (point spread function): the image of one point on a film at V.
struct ImpulseResponse {
    int width = 0;   ///< px.
    int height = 0;  ///< px.
    /// Share of the point's energy in each pixel, rows from the top, width * height values. The sum over all
    /// pixels of the film, beyond this raster as well, is 1.
    std::vector<float> values = {};
    double energy_in_frame = 0;    ///< Sum of `values`, up to 1.
    double coc_px = 0;             ///< Diameter of the geometric circle of confusion, px.
    double image_distance_mm = 0;  ///< Distance from the lens to the image of the point, mm.
    Report report = {};            ///< Of `postlens lens psf`.
};

/// The impulse response of a lens for a point on the optical axis. Throws Error(wrong_arguments).
/// @param settings Lens, point, wavelength and raster.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The impulse response.
[[nodiscard]] ImpulseResponse impulse_response(const ResponseSettings& settings, Job* job = nullptr);

}  // namespace postlens::api
