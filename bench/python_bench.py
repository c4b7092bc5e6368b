"""What the module costs beside the command's own work: time to import, time a picture, time to stop.

    PYTHONPATH=build/release/python python3 bench/python_bench.py
"""

import os
import pathlib
import signal
import statistics
import subprocess
import sys
import threading
import time
import warnings

import postlens

SCENE = pathlib.Path(__file__).resolve().parents[1] / "samples" / "scenes" / "bars.toml"


def import_s() -> float:
    """Less what Python and numpy take."""

    def took(code: str) -> float:
        times = []
        for _ in range(9):
            start = time.monotonic()
            subprocess.run([sys.executable, "-c", code], check=True)
            times.append(time.monotonic() - start)
        return statistics.median(times)

    return took("import postlens") - took("pass")


def overhead_ms(frame: postlens.Frame) -> float:
    over = []
    for i in range(31):
        start = time.monotonic()
        picture = frame.focus(f_number=1.4 + 0.1 * (i % 3), focus_m=2, method="scatter")
        over.append(1e3 * (time.monotonic() - start - picture.report["seconds"]))
    return statistics.median(over)


def stop_s(frame: postlens.Frame) -> float:
    """From Ctrl-C to the KeyboardInterrupt."""
    took = []
    for wait_s in (0.1, 0.2, 0.3, 0.5, 0.8):
        asked = []

        def interrupt() -> None:
            time.sleep(wait_s)
            asked.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt).start()
        try:
            frame.focus(f_number=1.4, focus_m=2, method="lightfield", views=4096)
        except KeyboardInterrupt:
            took.append(time.monotonic() - asked[0])
    return max(took)


warnings.simplefilter("ignore", postlens.PostlensWarning)
bars = postlens.trace(SCENE, size=(480, 270), for_f_number=1.4, for_focus_m=2)
print(f"import                {import_s():.2f} s")
print(f"beside the work       {overhead_ms(bars):.1f} ms a picture")
print(f"Ctrl-C to stop        {stop_s(bars):.2f} s at most")
