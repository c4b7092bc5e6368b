"""Pictures: arrays of pixels with their exposure, report and further channels."""

from __future__ import annotations

import numbers
import os
import tempfile
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _postlens
from ._command import PathLike, Report, path_text, run_words, shown
from ._errors import ArgumentError

Array = npt.NDArray[np.float32]

_geometry_keys = (
    "method", "views", "depths", "focus_m", "focal_length_mm", "f_number", "impulse", "largest_coc_px",
    "shutter_open_s", "shutter_close_s", "shutter_open_frames", "shutter_close_frames", "shutter_s", "spp",
    "seed", "crop",
)  # fmt: skip


def pixels_of(what: str, values: object) -> Array:
    """Converts an array of shape (height, width, 3 or 4) to float32 in C order. Its values must be floats."""
    if isinstance(values, np.ma.MaskedArray) and np.any(values.mask):
        raise ArgumentError(f"{what}: has masked values (got a masked array; expected e.g. its filled(0))")
    array = np.asarray(values)
    if array.dtype.kind != "f":
        raise ArgumentError(f"{what}: wrong type of values (got {array.dtype}; expected floats)")
    if array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape:
        raise ArgumentError(f"{what}: wrong shape (got {array.shape}; expected (height, width, 3 or 4))")
    return np.ascontiguousarray(array, dtype=np.float32)


class Picture:
    """A picture that postlens has made or read.

    array: float32 of shape (height, width, 3), or (height, width, 4) with alpha. The values are scene-linear: radiance
        times 2^exposure_stops. Row 0 is at the top. The array may be changed. Picture(array) copies it only if it is
        not float32 in C order.
    exposure_stops: the exposure of the array, or None if it is not known, as for a PNG file of another program.
    report: the JSON report of the command (--json), as a dict.
    passes: further channels by name, float32 of shape (height, width). The ids of a Cryptomatte are stored as the bits
        of the floats.
    """

    def __init__(
        self,
        array: object,
        exposure_stops: Optional[float] = 0.0,
        report: Optional[Report] = None,
        passes: Optional[dict[str, Array]] = None,
    ) -> None:
        self.array: Array = pixels_of("array", array)
        self.exposure_stops = exposure_stops
        self.report: Report = {} if report is None else report
        self.passes: dict[str, Array] = {} if passes is None else passes
        self.halves: list[Picture] = []

    @property
    def stated_db(self) -> Optional[float]:
        """PSNR against the exact picture, in dB, or None if it was not measured. The methods hybrid and auto measure it
        with rays while they make the picture, if a scene is given."""
        return self.report.get("stated_db")

    @property
    def stated_range_db(self) -> Optional[tuple[float, float]]:
        """The 95 % confidence interval of stated_db, in dB, or None if the error was not measured."""
        low, high = self.report.get("stated_low_db"), self.report.get("stated_high_db")
        return None if low is None else (low, float("inf") if high is None else high)

    @property
    def target_met(self) -> bool:
        """False if the picture does not reach target_db. With strict=True, also False if the records of the sample file
        do not suffice for the picture."""
        return bool(self.report.get("exit_code", 0) == 0)

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """The warnings, each with its code, its text and the fraction of the pixels that it concerns."""
        return list(self.report.get("warnings", []))

    @property
    def geometry(self) -> dict[str, Any]:
        """The lens, shutter and method with which the picture was made, by name. Names include units."""
        return {key: self.report[key] for key in _geometry_keys if self.report.get(key) is not None}

    @property
    def shape(self) -> tuple[int, ...]:
        return self.array.shape

    def save(self, path: PathLike) -> None:
        """Writes the picture as .exr (scene-linear), or as .png, .tif or .jpg (sRGB, clamped).

        If writing fails, no incomplete file remains.
        """
        _postlens.write_picture(path_text("path", path), pixels_of("array", self.array), self._stops())

    def _stops(self) -> Optional[float]:
        stops = self.exposure_stops
        if stops is None:
            return None
        if isinstance(stops, bool) or not isinstance(stops, numbers.Real) or not -100 <= stops <= 100:
            raise ArgumentError(f"exposure_stops: out of range (got {shown(stops)}; expected -100 to 100, or None)")
        return float(stops)

    def __array__(self, dtype: Any = None) -> npt.NDArray[Any]:
        return self.array if dtype is None else self.array.astype(dtype)

    def _repr_png_(self) -> bytes:
        return _postlens.png(pixels_of("array", self.array), self._stops())

    def __repr__(self) -> str:
        height, width = self.array.shape[:2]
        said = ", ".join(f"{k}={v!r}" for k, v in self.geometry.items())
        return f"<postlens.Picture {width}x{height}{', ' + said if said else ''}>"


def read_picture(path: PathLike) -> Picture:
    """Reads a picture from any file that OpenImageIO supports, and converts it to scene-linear values."""
    array, stops = _postlens.read_picture(path_text("path", path))
    return Picture(array, stops)


class _AsFiles:
    """Writes pictures and arrays to temporary files for the command `compare`, which reads files."""

    def __init__(self) -> None:
        self._folder: Optional[tempfile.TemporaryDirectory[str]] = None
        self.names: dict[str, str] = {}  #: of the files, for messages

    def __enter__(self) -> _AsFiles:
        return self

    def __exit__(self, *_: object) -> None:
        if self._folder is not None:
            self._folder.cleanup()

    def path(self, what: str, picture: object) -> str:
        if isinstance(picture, (str, os.PathLike)):
            return path_text(what, picture)
        stops = picture._stops() if isinstance(picture, Picture) else 0.0
        pixels = pixels_of(what, picture)
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="postlens-")
        path = os.path.join(self._folder.name, f"{what}.exr")
        _postlens.write_picture(path, pixels, stops)
        self.names[path] = what
        return path


def compare(
    image: object,
    reference: object,
    *,
    noise: object = None,
    pinhole: object = None,
    map: Optional[PathLike] = None,
    side_by_side: Optional[PathLike] = None,
    crop: Optional[tuple[int, int, int, int]] = None,
    exposure: "float | str | None" = None,
    flip_white: Optional[float] = None,
    threads: int = 0,
) -> Report:
    """Measures the error of a picture against its reference: PSNR, RMSE, relMSE, SSIM and FLIP.

    image, reference: a Picture, an array (height, width, 3 or 4) of floats, or a file.
    noise: an independent render of the reference. With it, the noise of the reference is subtracted from the error.
    pinhole: the picture without a lens. With it, the report also states the error of the pixels that the lens changes.
    map, side_by_side: image files to write, which show the differences.
    crop: the part of the pictures that is compared, (x, y, width, height) in px.
    exposure: the exposure at which all pictures are compared, in stops or "auto". The default is the exposure of the
        reference.

    Returns a dict with psnr_db, rmse, relmse, ssim, flip and more: the report of `postlens compare --json`.
    Raises ArgumentError for wrong shapes or types, and InputError for unequal sizes.
    """
    with _AsFiles() as files:
        options = {
            "noise": None if noise is None else files.path("noise", noise),
            "pinhole": None if pinhole is None else files.path("pinhole", pinhole),
            "map": map,
            "side_by_side": side_by_side,
            "crop": crop,
            "exposure": exposure,
            "flip_white": flip_white,
        }
        words = ["compare", files.path("image", image), files.path("reference", reference)]
        return run_words(words, options, threads, file_names=files.names)[0]
