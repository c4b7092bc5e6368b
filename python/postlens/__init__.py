"""postlens: renders a scene once through a pinhole, and applies the lens and the shutter afterwards.

    import postlens
    frame = postlens.trace("scene.toml", size=(960, 540), for_f_number=1.4)
    picture = frame.focus(f_number=1.4, focus_m=2)
    picture.save("focused.png")

trace(scene) traces a scene and returns a Frame. open(path) opens a file as a Frame. The file is a sample file or a
picture of another program. The methods of a Frame make pictures: focus(), motionblur(), shoot(), sweep(), image().

render(scene, spp=...) renders a reference by distributed rays, and compare(a, b) measures the error of a picture. The
module lens computes circles of confusion, depths of field and impulse responses. run() runs any other command.

Arguments have the names of the command's options, with the unit at the end. For example, --focus is focus_m.
"""

from __future__ import annotations

from . import lens
from ._command import PathLike, Progress, Report, run_words, whole
from ._errors import (
    ArgumentError,
    Cancelled,
    Error,
    InputError,
    OutOfMemoryError,
    OutputError,
    PostlensWarning,
)
from ._frame import Frame, open, render, trace
from ._picture import Picture, compare, read_picture
from ._postlens import Records, __version__

__all__ = [
    "ArgumentError",
    "Cancelled",
    "Error",
    "Frame",
    "InputError",
    "OutOfMemoryError",
    "OutputError",
    "Picture",
    "PostlensWarning",
    "Records",
    "Report",
    "compare",
    "lens",
    "open",
    "read_picture",
    "render",
    "run",
    "trace",
    "__version__",
]


def run(*words: object, threads: int = 0, progress: Progress = None) -> Report:
    """Runs any command, with the words of the command line: run("chart", "scene.toml", "-o", "folder").

    Returns the JSON report of the command (--json). report["text"] is the text that the command prints without --json,
    and report["exit_code"] is its exit code. Raises an exception if the command fails, or if it makes a picture and no
    output is given.
    """
    return run_words([whole("run", str(word)) for word in words], None, threads, progress, pictures_stay=False)[0]
