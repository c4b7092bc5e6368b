#!/usr/bin/python3
"""Measures what shares cost and how many of them are worthwhile: the table of docs/farm.md.

    farm_table.py BUILD OUT

BUILD is a build folder (build/release). Each command is divided into shares (--share), and `merge` joins the results.
Three times are measured with all threads of this machine: the time of the undivided run, the time of the smallest
possible share, and the time of merging one part. From these, the script computes the time of N shares on N such
machines: the time of the longest share plus that of the merge. Real runs with 4 shares check the computed times. A
second table compares the predictions of `--dry-run` with real runs. Both tables are written to OUT as farm.md.
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes")
TASKS = (1, 10, 100, 1000)
REPEATS = 3


def told_and_measured(program, at, lens, bars, life):
    """Compares the predictions of --dry-run for a task in the middle with the measured cost of this task."""
    subprocess.run([program, "trace", bars, "-o", at("bars.exr"), "--size", "960x540", "--for-f-number", "1.4",
                    "--for-focus", "5", "--quiet"], check=True)  # fmt: skip
    focus = ["focus", at("bars.exr"), *lens, "-o"]
    works = [
        ("`focus --method lightfield`, 256 views, rows", 4, [*focus, at("p.exr"), "--method", "lightfield", "--views", "256"]),
        ("`focus --method layers`, rows", 4, [*focus, at("p.exr"), "--method", "layers"]),
        ("`focus --scene`, alone", 1, [*focus, at("p.exr"), "--scene", bars]),
        ("`trace`, rows", 4, ["trace", bars, "--size", "960x540", "--for-f-number", "1.4", "-o", at("p.exr")]),
        ("`trace`, alone", 1, ["trace", bars, "--size", "960x540", "--for-f-number", "1.4", "-o", at("p.exr")]),
        ("`render`, 256 samples, rows", 8, ["render", bars, "--size", "480x270", "--spp", "256", *lens, "-o", at("p.exr")]),
        ("`render`, 256 samples, by samples", 4, ["render", life, "--size", "240x160", "--spp", "256", "--f-number", "1.8",
                                                  "--focus", "0.8", "--share-by", "samples", "-o", at("p.exr")]),
        ("`render`, 12 frames", 3, ["render", bars, "--size", "240x135", "--spp", "64", "--frames", "0-11", *lens, "-o", at("f.%d.exr")]),
        ("`sweep`, 10 lenses", 3, ["sweep", at("bars.exr"), "--f-number", "1.4:5.6:1", "--focus", "1,5", "--method", "scatter",
                                   "-o", at("sweep")]),
    ]  # fmt: skip
    lines = ["", "| work | shares | predicted, s | measured, s | predicted, MB | measured, MB | `--dry-run` itself, s |", "|---|---|---|---|---|---|---|"]
    for name, shares, words in works:
        def run(*more):
            start = time.monotonic()
            out = subprocess.run([program, *words, *more, "--json"], check=True, capture_output=True, text=True).stdout
            return json.loads(out), time.monotonic() - start

        said, dry_s = run("--share", f"0/{shares}", "--dry-run")
        task = said["tasks"][shares // 2]
        share = ["--share", f"{shares // 2}/{shares}"] if shares > 1 else []
        runs = []
        for _ in range(REPEATS):
            shutil.rmtree(at("sweep"), ignore_errors=True)
            runs.append(run(*share))
        measured = statistics.median(seconds for _, seconds in runs)
        lines.append(f"| {name} | {shares} | {task['seconds']:.2f} | {measured:.2f} | {task['memory_bytes'] / 1e6:.0f} | "
                     f"{max(r['peak_memory_bytes'] for r, _ in runs) / 1e6:.0f} | {dry_s:.1f} |")  # fmt: skip
        print(lines[-1], flush=True)
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    program = os.path.join(o.build, "apps", "postlens")
    if not os.access(program, os.X_OK):
        sys.exit(f"farm_table.py: {program} is missing; build the target postlens")

    def run(*words):
        """Runs a command several times and returns the least wall time, in seconds. Other work on the machine can only
        add time."""
        least = float("inf")
        for _ in range(REPEATS):
            start = time.monotonic()
            subprocess.run([program, *words, "--quiet"], check=True)
            least = min(least, time.monotonic() - start)
        return least

    def at(name):
        return os.path.join(o.out, name)

    lens = ["--f-number", "1.4", "--focus", "5"]
    bars, life = (os.path.join(SCENES, name + ".toml") for name in ("bars", "still_life"))
    subprocess.run([program, "trace", life, "-o", at("life.exr"), "--size", "960x540", "--for-f-number", "1.8",
                    "--for-focus", "0.8", "--overscan", "auto", "--quiet"], check=True)  # fmt: skip
    works = [
        ("`focus --method lightfield`, still_life, 960x540, 256 views", 540, [],
         ["focus", at("life.exr"), "--method", "lightfield", "--views", "256", "--f-number", "1.8", "--focus", "0.8"]),
        ("`render`, bars, 960x540, 64 samples, by rows", 540, [], ["render", bars, "--size", "960x540", "--spp", "64", *lens]),
        ("`render`, bars, 480x270, 1024 samples, by samples", 64, ["--share-by", "samples"],
         ["render", bars, "--size", "480x270", "--spp", "1024", *lens]),
    ]  # fmt: skip
    lines = ["| work | undivided, s | fixed cost of a task, s | merge of each part, s | " +
             " | ".join(f"{n} tasks" for n in TASKS) + " | 4 shares: simulated, measured, s |", "|---" * (5 + len(TASKS)) + "|"]  # fmt: skip
    for name, most, by, words in works:
        whole = run(*words, "-o", at("whole.exr"))
        before = run(*words, *by, "-o", at("small.exr"), "--share", f"{most // 2}/{most}")
        parts = [at(f"part{i}.exr") for i in range(4)]
        shares = [run(*words, *by, "-o", part, "--share", f"{i}/4") for i, part in enumerate(parts)]
        of_four = run("merge", *parts, "-o", at("merged.exr"))
        with open(at("whole.exr"), "rb") as a, open(at("merged.exr"), "rb") as b:
            if a.read() != b.read():
                sys.exit(f"farm_table.py: {name}: the merged file is not the undivided one")
        # Computes the seconds that `merge` needs for each share (the part of the work that one task does). `of_four`
        # is the measured time of joining four shares.
        merge = of_four / 4
        # If shares divide the samples (`by`), each share is as large as the whole image, so the time grows with the
        # number of shares. If they divide the rows, all shares together are as large as one image, so
        # `per_part` is 0.
        per_part = merge if by else 0.0

        def simulated(n):
            if n > most:
                return None
            if n == 1:
                return whole
            return before + (whole - before) / n + (per_part * n if by else of_four)

        cells = [f"{simulated(n):.2g} s" if simulated(n) else "-" for n in TASKS]
        lines.append(f"| {name} | {whole:.2f} | {before:.2f} | {merge:.3f} | {' | '.join(cells)} | "
                     f"{simulated(4):.2f}, {max(shares) + of_four:.2f} |")  # fmt: skip
        print(lines[-1], flush=True)
    lines += told_and_measured(program, at, lens, bars, life)
    with open(at("farm.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    with open(at("farm.json"), "w", encoding="utf-8") as f:
        json.dump({"rows": lines[2:]}, f, indent=2)


if __name__ == "__main__":
    main()
