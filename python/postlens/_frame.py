"""Frames: sample files, or pictures of other programs. Pictures are made from them."""

from __future__ import annotations

import itertools
import numbers
import os
import tempfile
import weakref
from typing import Any, Iterable, Iterator, Mapping, Optional, Sequence, Union

from . import _postlens
from ._command import PathLike, Progress, Report, path_text, run_words, shown, words_of
from ._errors import ArgumentError, InputError
from ._picture import Picture

Span = tuple[float, float]
Exposure = Union[float, str, None]
#: Function arguments that are not options of the command.
_not_options = {"self", "threads", "progress"}


def picture_of(
    words: list[str],
    options: dict[str, Any],
    kept: Optional["_postlens.KeptFrame"] = None,
) -> Picture:
    """Runs a command and returns its picture, which stays in memory. `options` are the caller's arguments, in the form
    in which locals() returns them."""
    asked = {k: v for k, v in options.items() if k not in _not_options}
    report, pictures = run_words(words, asked, options["threads"], options["progress"], kept)
    made = [Picture(array, stops, report, passes) for array, stops, passes in pictures]
    made[0].halves = made[1:]
    return made[0]


def _version(path: str) -> Optional[tuple[int, int, int, int]]:
    """Returns a value that identifies the present version of a file, or None if there is no file."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


class Frame:
    """A sample file, or a picture of another program that has depth. Pictures are made from it.

    The records stay in memory and are used for all pictures. A frame makes one picture at a time. Several frames can
    make pictures in several threads at the same time.
    """

    def __init__(self, path: PathLike, *, salvage: bool = False) -> None:
        self._path = path_text("path", path)
        self._salvage = salvage
        self._file = _version(self._path)
        #: The report of `postlens info --json` for the file.
        self.info: Report = run_words(["info", self._path], {"salvage": salvage})[0]
        if self.info["kind"] not in ("samples", "image"):
            raise ArgumentError(
                f"{self._path}: nothing to focus (got a {self.info['kind']}; expected a sample file or a picture)"
            )
        #: The report of `postlens trace --json` if trace() wrote the file of this frame, otherwise None.
        self.trace_report: Optional[Report] = None
        self._kept: Optional[_postlens.KeptFrame] = None
        if self.info["kind"] == "samples":
            self._kept = _postlens.KeptFrame(self._path, salvage)

    @property
    def path(self) -> str:
        return self._path

    @property
    def width(self) -> int:
        """Width of the pictures made from the file, px."""
        return int(self.info["width"])

    @property
    def height(self) -> int:
        """Height of the pictures made from the file, px."""
        return int(self.info["height"])

    def __repr__(self) -> str:
        return f"<postlens.Frame {self._path!r} {self.width}x{self.height}>"

    def _check_file(self) -> None:
        """Raises InputError if another file has replaced the file that was opened. A removed file is no error, because
        its records are still in memory."""
        now = _version(self._path)
        if now is not None and now != self._file:
            raise InputError(f"{self._path}: has changed since it was opened (expected it to be opened again)")

    def _words(self, command: str) -> list[str]:
        self._check_file()
        return [command, self._path] + words_of({"salvage": self._salvage})

    def image(
        self,
        *,
        crop: Optional[tuple[int, int, int, int]] = None,
        exposure: Exposure = None,
        layer: Optional[str] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> Picture:
        """Computes the picture through a pinhole from the records, without rays. Arguments are as in focus()."""
        return picture_of(self._words("image"), locals(), self._kept)

    def focus(
        self,
        *,
        f_number: Optional[float] = None,
        focus_m: Optional[float] = None,
        focus_at: Optional[tuple[float, float]] = None,
        focal_length_mm: Optional[float] = None,
        method: Optional[str] = None,
        views: Optional[int] = None,
        depths: Optional[int] = None,
        target_db: Optional[float] = None,
        scene: Optional[PathLike] = None,
        framing: Optional[str] = None,
        breathing: bool = False,
        impulse: Optional[str] = None,
        squeeze: Optional[float] = None,
        cats_eye: Optional[float] = None,
        spherical: Optional[float] = None,
        spacing: Optional[str] = None,
        depth_model: Optional[str] = None,
        crop: Optional[tuple[int, int, int, int]] = None,
        exposure: Exposure = None,
        metres_per_unit: Optional[float] = None,
        lumens_per_watt: Optional[float] = None,
        explain: Optional[PathLike] = None,
        predict: bool = False,
        strict: bool = False,
        behind: Union[PathLike, Sequence[PathLike], None] = None,
        behind_layer: Optional[str] = None,
        holdout: Union[PathLike, Sequence[PathLike], None] = None,
        keep_sharp: Union[PathLike, Sequence[PathLike], None] = None,
        focus_offset: Optional[Mapping[str, float]] = None,
        matte: Optional[PathLike] = None,
        passes: Union[str, Sequence[str], None] = None,
        layer: Optional[str] = None,
        depth_channel: Optional[str] = None,
        depth_encoding: Optional[str] = None,
        depth_file: Optional[PathLike] = None,
        ids: Optional[str] = None,
        ids_file: Optional[PathLike] = None,
        film_width_mm: Optional[float] = None,
        film_distance_mm: Optional[float] = None,
        overscan_px: Optional[int] = None,
        z: Optional[str] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> Picture:
        """Makes the picture through a lens.

        f_number: the f-number, or math.inf for a pinhole. The default is the f-number in the file.
        focus_m, focus_at: the focus distance in m, or the pixel (x, y) to focus on.
        focal_length_mm: the focal length. It does not change the field of view, unless framing="lens".
        method: "scatter", "layers", "lightfield", "hybrid", "auto" or "pinhole".
        views: number of lens points to which the methods "lightfield" and "hybrid" reproject the records.
        target_db: the PSNR, in dB, that "auto" must reach.
        scene: the scene from which the frame was traced. With a scene, rays replace samples that the records do not
            determine, and the error of the picture is measured (Picture.stated_db).
        impulse: the image of a point that is out of focus: "disc", "polygon:6", "image:aperture.png", "lens:FILE", ...
        crop: the rectangle to compute, (x, y, width, height) in px.
        exposure: stops or "auto".
        behind: pictures of the same camera that lie behind this one, nearest first.
        behind_layer: the layer of the pictures in `behind`.
        holdout, keep_sharp, matte: objects in a picture of another program, by name, number or mask file.
        focus_offset: for each object, an offset of its focus, in m.
        passes: any of "coc", "sides", "cryptomatte", "error". They are returned in Picture.passes.
        layer, depth_channel, depth_encoding, depth_file, ids, ids_file, film_width_mm, film_distance_mm, overscan_px,
            z: how to read a picture of another program, see docs/inputs.md.
        threads: number of threads, or 0 for all.
        progress: a function that is called as progress(fraction, seconds_left) during the work. If it raises an
            exception, the work stops and the exception is raised here.
        `postlens focus --help` describes the other arguments.

        Returns a Picture. Raises ArgumentError, InputError or OutOfMemoryError with the command's message.
        """
        return picture_of(self._words("focus"), locals(), self._kept)

    def shoot(
        self,
        *,
        f_number: Optional[float] = None,
        focus_m: Optional[float] = None,
        focus_at: Optional[tuple[float, float]] = None,
        focal_length_mm: Optional[float] = None,
        shutter: Optional[Span] = None,
        shutter_curve: Optional[str] = None,
        paths: Optional[PathLike] = None,
        method: Optional[str] = None,
        views: Optional[int] = None,
        target_db: Optional[float] = None,
        scene: Optional[PathLike] = None,
        framing: Optional[str] = None,
        breathing: bool = False,
        impulse: Optional[str] = None,
        squeeze: Optional[float] = None,
        cats_eye: Optional[float] = None,
        spherical: Optional[float] = None,
        crop: Optional[tuple[int, int, int, int]] = None,
        exposure: Exposure = None,
        metres_per_unit: Optional[float] = None,
        lumens_per_watt: Optional[float] = None,
        explain: Optional[PathLike] = None,
        predict: bool = False,
        strict: bool = False,
        threads: int = 0,
        progress: Progress = None,
    ) -> Picture:
        """Makes the picture through a lens and an open shutter.

        shutter: (open, close), in seconds on the scene's clock. The default is the exposure in the file.
        shutter_curve: "box", "triangle" or a file.
        paths: a file with the motion of objects.
        Other arguments are as in focus().
        """
        return picture_of(self._words("shoot"), locals(), self._kept)

    def motionblur(
        self,
        *,
        shutter: Optional[Span] = None,
        shutter_curve: Optional[str] = None,
        paths: Optional[PathLike] = None,
        method: Optional[str] = None,
        views: Optional[int] = None,
        target_db: Optional[float] = None,
        scene: Optional[PathLike] = None,
        fit_paths_px: Optional[float] = None,
        vectors: Optional[tuple[str, str]] = None,
        vector_scale: Union[float, tuple[float, float], None] = None,
        vector_offset: Union[float, tuple[float, float], None] = None,
        vectors_file: Optional[PathLike] = None,
        crop: Optional[tuple[int, int, int, int]] = None,
        exposure: Exposure = None,
        metres_per_unit: Optional[float] = None,
        lumens_per_watt: Optional[float] = None,
        explain: Optional[PathLike] = None,
        predict: bool = False,
        strict: bool = False,
        layer: Optional[str] = None,
        depth_channel: Optional[str] = None,
        depth_encoding: Optional[str] = None,
        depth_file: Optional[PathLike] = None,
        ids: Optional[str] = None,
        ids_file: Optional[PathLike] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> Picture:
        """Makes the picture through a pinhole and an open shutter.

        shutter: (open, close), in seconds on the scene's clock. For a picture with motion vectors, the unit is a frame:
            0 is this frame, and 1 is the next.
        method: "convolve", "lightfield" or "auto".
        vectors, vector_scale, vector_offset, vectors_file: how to read motion vectors, see docs/motion_vectors.md.
        Other arguments are as in focus().
        """
        return picture_of(self._words("motionblur"), locals(), self._kept)

    def sweep(
        self,
        *,
        f_number: Union[float, Sequence[float], None] = None,
        focus_m: Union[float, Sequence[float], None] = None,
        focal_length_mm: Union[float, Sequence[float], None] = None,
        impulse: Union[str, Sequence[str], None] = None,
        shutter: Union[Span, Sequence[Span], None] = None,
        **options: Any,
    ) -> Iterator[Picture]:
        """Yields a picture for every combination of the values. The values of the last argument change fastest.

        The records stay in memory between pictures. Other options are those of focus(), or those of shoot() if a
        shutter is given. Picture.geometry contains the settings of each picture.
        """
        axes: dict[str, Sequence[Any]] = {}
        given: dict[str, Any] = {
            "f_number": f_number, "focus_m": focus_m, "focal_length_mm": focal_length_mm, "impulse": impulse,
            "shutter": shutter,
        }  # fmt: skip
        for name, values in given.items():
            if values is None:
                continue
            one = isinstance(values, (str, bytes, os.PathLike)) or not isinstance(values, Iterable)
            # A numpy array of dimension 0 claims to be Iterable, but cannot be iterated.
            axes[name] = [values] if one or getattr(values, "ndim", 1) == 0 else list(values)
            if not axes[name]:
                raise ArgumentError(f"{name}: no values (got an empty sequence; expected one or more)")
            if name == "shutter" and all(isinstance(v, numbers.Real) for v in axes[name]):
                axes[name] = [axes[name]]  # one pair (open, close)
        make: Any = self.focus if shutter is None else self.shoot

        def pictures() -> Iterator[Picture]:
            for values in itertools.product(*axes.values()):
                yield make(**dict(zip(axes, values)), **options)

        return pictures()

    def records(self, *, key: int = 0) -> "_postlens.Records":
        """Reads the records of the recorded instant number `key`. Number 0 is the instant of the pinhole picture.
        Returns numpy columns, which are views of one array and are not copied. Colours are radiance."""
        if self._kept is None:
            raise ArgumentError(f"{self._path}: has no records (got a picture; expected a sample file)")
        if isinstance(key, bool) or not isinstance(key, numbers.Integral) or not 0 <= key < 2**31:
            raise ArgumentError(f"key: out of range (got {shown(key)}; expected 0 or more)")
        self._check_file()
        return _postlens.read_records(self._path, int(key), self._salvage)

    def tree_at(self, x: float, y: float, **options: Any) -> Report:
        """Returns the shading trees at a pixel, in the form of `postlens records --json`.

        The report lists the point samples of the pixel with their weights, and for each sample the nodes of its shading
        tree. A node has path, id, name, z' (depth) and W. If the arguments or the file define the lens, it also has the
        diameter of its circle of confusion.
        """
        return run_words(self._words("records"), {"at": (x, y), **options})[0]


def open(path: PathLike, *, salvage: bool = False) -> Frame:
    """Opens a sample file, or an OpenEXR picture of another program. With `salvage`, the undamaged rows of a damaged
    sample file are read."""
    return Frame(path, salvage=salvage)


def trace(
    scene: PathLike,
    *,
    output: Optional[PathLike] = None,
    size: Optional[tuple[int, int]] = None,
    camera: Optional[str] = None,
    for_f_number: Optional[float] = None,
    for_focus_m: Optional[float] = None,
    for_shutter: Optional[Span] = None,
    for_rays: bool = False,
    subdivide: Optional[int] = None,
    threshold: Optional[float] = None,
    hidden_layers: Union[int, str, None] = None,
    overscan_px: Union[int, str, None] = None,
    keys: Union[int, str, None] = None,
    time_s: Optional[float] = None,
    film_width_mm: Optional[float] = None,
    film_distance_mm: Optional[float] = None,
    max_depth: Optional[int] = None,
    min_contribution: Optional[float] = None,
    plan: bool = False,
    target_db: Optional[float] = None,
    compression: Optional[str] = None,
    exposure: Exposure = None,
    metres_per_unit: Optional[float] = None,
    lumens_per_watt: Optional[float] = None,
    force: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Frame:
    """Traces a scene through a pinhole, once for all lenses.

    output: the sample file to write. Without it, a temporary file is written, which is removed with the Frame.
    size: (width, height) in px. The default is the size that the camera states.
    for_f_number, for_shutter: the smallest f-number and the shutter for which the records must suffice.
    for_focus_m: the focus distance for which overscan_px="auto" and `plan` make the records suffice.
    for_rays: whether pictures will be made with rays (the argument `scene` of Frame.focus). Coarse records then
        suffice.
    plan: chooses subdivision, hidden layers, overscan and recorded instants for target_db.
    `postlens trace --help` describes the other arguments.

    Returns the Frame. Its trace_report is the report of `postlens trace --json`.
    """
    options = {k: v for k, v in locals().items() if k not in ("scene", "output", "threads", "progress")}
    folder: Optional[tempfile.TemporaryDirectory[str]] = None
    if output is None:
        folder = tempfile.TemporaryDirectory(prefix="postlens-")
        output = os.path.join(folder.name, "frame.exr")
    try:
        path = path_text("output", output)
        words = ["trace", path_text("scene", scene), "--output=" + path]
        report, _ = run_words(words, options, threads, progress)
        frame = Frame(path)
    except BaseException:
        if folder is not None:
            folder.cleanup()
        raise
    frame.trace_report = report
    if folder is not None:
        weakref.finalize(frame, folder.cleanup)
    return frame


def render(
    scene: PathLike,
    *,
    spp: int,
    size: Optional[tuple[int, int]] = None,
    camera: Optional[str] = None,
    f_number: Optional[float] = None,
    focus_m: Optional[float] = None,
    focus_at: Optional[tuple[float, float]] = None,
    focal_length_mm: Optional[float] = None,
    framing: Optional[str] = None,
    breathing: bool = False,
    impulse: Optional[str] = None,
    squeeze: Optional[float] = None,
    cats_eye: Optional[float] = None,
    spherical: Optional[float] = None,
    time_s: Optional[float] = None,
    shutter: Optional[Span] = None,
    shutter_curve: Optional[str] = None,
    sampler: Optional[str] = None,
    seed: Optional[int] = None,
    halves: bool = False,
    film_width_mm: Optional[float] = None,
    film_distance_mm: Optional[float] = None,
    max_depth: Optional[int] = None,
    min_contribution: Optional[float] = None,
    crop: Optional[tuple[int, int, int, int]] = None,
    exposure: Exposure = None,
    metres_per_unit: Optional[float] = None,
    lumens_per_watt: Optional[float] = None,
    threads: int = 0,
    progress: Progress = None,
) -> Picture:
    """Renders the reference by distributed rays over lens and time.

    spp: samples per pixel.
    halves: also keeps two pictures of independent halves of the samples (Picture.halves). Their difference measures the
        noise.
    Other arguments are as in Frame.focus() and trace().
    """
    options = dict(locals())
    return picture_of(["render", path_text("scene", options.pop("scene"))], options)
