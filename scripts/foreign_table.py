#!/usr/bin/python3
"""Measures the time and the memory of focusing another program's frames: the figures of docs/compositing.md.

    foreign_table.py BUILD OUT [--repeat K] [--frames N]

BUILD is a build folder (build/release) with the target foreign_export. A scene of bars is traced through a pinhole at
1920x1080, once with all objects and once without the near objects. bench/foreign_export.cpp writes each of the two as
another program would: as a flat image with a Cryptomatte, and as a deep image. For each row of the table, `postlens
focus` runs K times. The row states the median time and the largest peak of memory. If other programs run at the same
time, only the processor time of all threads can be compared. A second table states the peak of memory for 1 frame, for
5 frames and for N frames of 688x408 px. The images and foreign.md with the tables are written to OUT.
"""

import argparse
import os
import statistics
import subprocess
import sys
import time

from behind_table import BARS, NEAR, without

FOCUS = ["--f-number", "1.4", "--focus", "5", "--metres-per-unit", "1", "--z", "axial", "--quiet"]
FEW_FRAMES = 5


def timed(words):
    """Runs a process. Returns its wall time and its processor time, in seconds, and its peak memory, in MB."""
    start = time.monotonic()
    process = subprocess.Popen(words)  # pylint: disable=consider-using-with
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"foreign_table.py: {' '.join(words)} failed")
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--repeat", type=int, default=5, help="rounds")
    parser.add_argument("--frames", type=int, default=100, help="of the longer range")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    program = os.path.join(o.build, "apps", "postlens")
    export = os.path.join(o.build, "bench", "foreign_export")

    def at(name):
        return os.path.join(o.out, name)

    with open(BARS, encoding="utf-8") as f:
        text = f.read()
    for name, size, left_out in (("whole", "1920x1080", []), ("behind", "1920x1080", NEAR), ("small", "688x408", [])):
        with open(at(name + ".toml"), "w", encoding="utf-8") as f:
            f.write(without(text, left_out))
        records = at("records.exr")
        subprocess.run([program, "trace", at(name + ".toml"), "-o", records, "--size", size, "--quiet"], check=True)
        subprocess.run([export, records, at(f"{name}.flat.exr"), "most", "cryptomatte"], check=True)
        subprocess.run([export, records, at(f"{name}.deep.exr"), "deep"], check=True)
        os.remove(records)

    def focus(picture, *more):
        return [program, "focus", at(picture), "-o", at("made.exr"), *FOCUS, *more]

    flat, deep, behind = "whole.flat.exr", "whole.deep.exr", at("behind.flat.exr")
    rows = {
        "flat, read and written only (`pinhole`)": focus(flat, "--method", "pinhole"),
        "flat, `scatter`": focus(flat, "--method", "scatter"),
        "flat, `layers`": focus(flat, "--method", "layers"),
        "flat, `layers`, one behind": focus(flat, "--method", "layers", "--behind", behind),
        "flat, `layers`, the pass `cryptomatte`": focus(flat, "--method", "layers", "--passes", "cryptomatte"),
        "flat, `lightfield`, 64 views, one behind": focus(flat, "--method", "lightfield", "--behind", behind),
        "deep, read and written only (`pinhole`)": focus(deep, "--method", "pinhole"),
        "deep, `layers`": focus(deep, "--method", "layers"),
        "deep, `lightfield`, 64 views": focus(deep, "--method", "lightfield"),
    }
    runs = {name: [] for name in rows}
    for _ in range(o.repeat):
        for name, words in rows.items():
            runs[name].append(timed(words))
    lines = ["| 1920x1080 | s | s of all threads | peak memory, MB |", "|---|---|---|---|"]
    for name, measured in runs.items():
        seconds, of_threads, megabytes = zip(*measured)
        lines.append(f"| {name} | {statistics.median(seconds):.1f} | {statistics.median(of_threads):.1f} | {max(megabytes):.0f} |")

    lines += ["", f"| 688x408, `layers`: peak memory, MB | 1 frame | {FEW_FRAMES} frames | {o.frames} frames |", "|---|---|---|---|"]
    for kind in ("flat", "deep"):
        cells = []
        for frames in (1, FEW_FRAMES, o.frames):
            for i in range(1, frames + 1):
                link = at(f"f.{i:04d}.exr")
                if os.path.lexists(link):
                    os.remove(link)
                os.symlink(f"small.{kind}.exr", link)
            *_, megabytes = timed([program, "focus", at("f.%04d.exr"), "-o", at("made.%04d.exr"), "--frames", f"1-{frames}",
                                  "--method", "layers", *FOCUS])  # fmt: skip
            cells.append(f"{megabytes:.0f}")
        lines.append(f"| {kind} | {' | '.join(cells)} |")
    with open(at("foreign.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
