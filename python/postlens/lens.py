"""Properties of lenses: circle of confusion, depth of field, impulse responses, prescriptions."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Optional

from ._command import PathLike, Report, path_text, run_words
from ._picture import Picture, read_picture


def coc(
    *,
    focal_length_mm: float,
    f_number: float,
    focus_m: float,
    depth_m: float,
    coc_limit_mm: Optional[float] = None,
    pixel_pitch_um: Optional[float] = None,
) -> Report:
    """Returns the diameter of the circle of confusion of a point at depth_m, as coc_mm and coc_px. The formula is that
    of Potmesil and Chakravarty (1981). Also returns the depth of field."""
    return run_words(["lens", "coc"], locals())[0]


def dof(
    *,
    focal_length_mm: float,
    f_number: float,
    focus_m: float,
    coc_limit_mm: Optional[float] = None,
    pixel_pitch_um: Optional[float] = None,
) -> Report:
    """Returns the range of depths that appear sharp, from near_m to far_m, and hyperfocal_m. If the range extends to
    infinity, far_m is None."""
    return run_words(["lens", "dof"], locals())[0]


def psf(
    *,
    focal_length_mm: Optional[float] = None,
    f_number: Optional[float] = None,
    focus_m: Optional[float] = None,
    depth_m: Optional[float] = None,
    wavelength_nm: Optional[float] = None,
    pixel_pitch_um: Optional[float] = None,
    size_px: Optional[int] = None,
    impulse: Optional[str] = None,
    squeeze: Optional[float] = None,
    spherical: Optional[float] = None,
) -> Picture:
    """Returns the impulse response, which is the image of one scene point. Its values are the energy per pixel, and are
    the same in all three channels."""
    options: dict[str, Any] = dict(locals())
    with tempfile.TemporaryDirectory(prefix="postlens-") as folder:
        path = os.path.join(folder, "psf.exr")
        report, _ = run_words(["lens", "psf", path], options)
        picture = read_picture(path)
    picture.report = report
    return picture


def prescription(
    path: PathLike,
    *,
    f_number: Optional[float] = None,
    focus_m: Optional[float] = None,
    wavelength_nm: Optional[float] = None,
    focus_by: Optional[str] = None,
    move: Optional[str] = None,
    film_width_mm: Optional[float] = None,
    output: Optional[PathLike] = None,
) -> Report:
    """Returns focal lengths, pupils and more of a lens prescription (.dat, .zmx, .seq, .toml). If `output` is given, a
    drawing of the lens is written to this file."""
    options = dict(locals())
    words = ["lens", "show", path_text("path", options.pop("path"))]
    return run_words(words, options)[0]
