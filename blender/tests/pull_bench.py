"""Measures the time of a focus pull in Blender: passes rendered once and focused by postlens, against Cycles' lens.

    blender -b --factory-startup -noaudio --python-exit-code 1 -P pull_bench.py -- POSTLENS [SIZE [FRAMES]]

The error of Cycles is inversely proportional to the square root of its samples. Cycles would therefore reach the error
of postlens in this time: the time of the reference, times the squared error of the reference, divided by the squared
error of postlens.
"""

import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from blender_bench import Program, bars, by_cycles, bpy, folder, words  # noqa: E402

PINHOLE_SPP, REFERENCE_SPP = 32, 128
NEAR_M, FAR_M = 3, 12


def main():
    program = Program(words()[0])
    size = (words()[1:2] or ["640x360"])[0]
    frames = int((words()[2:3] or ["24"])[0])
    scene = bars(size, PINHOLE_SPP)
    scene.frame_start, scene.frame_end = 1, frames
    dof = scene.camera.data.dof
    for frame, focus_m in ((1, NEAR_M), (frames, FAR_M)):
        dof.focus_distance = focus_m
        dof.keyframe_insert("focus_distance", frame=frame)
    with folder() as out:
        s = scene.postlens
        s.program, s.folder, s.only_lens_changes = program.path, out, True
        start = time.monotonic()
        bpy.ops.postlens.focus(animation=True)
        seconds = time.monotonic() - start
        lines = [f"{size}, {frames} frames, f/{dof.aperture_fstop:g}: {seconds:.1f} s by postlens, passes and all"]
        cycles_s = 0
        looked = sorted({1, (1 + frames) // 2, frames})
        for frame in looked:
            scene.frame_set(frame)
            start = time.monotonic()
            halves = [by_cycles(scene, os.path.join(out, f"half{i}.exr"), REFERENCE_SPP, i) for i in (1, 2)]
            reference_s = time.monotonic() - start
            psnr, noise = program.psnr_db(os.path.join(out, f"focused.{frame:04d}.exr"), halves)
            equal_s = reference_s * 10 ** ((psnr - noise) / 10)
            cycles_s += equal_s / len(looked)
            lines.append(f"  frame {frame}: {psnr:.1f} dB (Cycles with {2 * REFERENCE_SPP} samples: {noise:.1f} dB in "
                         f"{reference_s:.1f} s, so {equal_s:.1f} s at equal error)")  # fmt: skip
        lines.append(f"  a picture of the pull: {seconds / frames:.2f} s, Cycles {cycles_s:.1f} s: {cycles_s * frames / seconds:.1f} times")
    print("\n".join(lines))


main()
