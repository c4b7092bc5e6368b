#!/usr/bin/python3
"""What shares cost and how many of them pay: the table of docs/farm.md.

    farm_table.py BUILD OUT

BUILD is a built folder (build/release). For each work it measures, with all threads of this machine, the undivided run, the
cost of a task before it works (the smallest share that there is), and what merging costs for each part. From these it
simulates N tasks on N such machines that begin at once: the longest task, and the merge after it. Real shares of 4 check
the model. OUT gets the table as farm.md.
"""

import argparse
import json
import os
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes")
TASKS = (1, 10, 100, 1000)
REPEATS = 3


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
        """Seconds of a whole process; the least of some, as other work of the machine only adds to it."""
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
    lines = ["| work | undivided, s | a task before it works, s | merge of each part, s | " +
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
        # Parts by rows are as large together as the picture; those of samples are as large as the picture each.
        merge = of_four / 4
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
    with open(at("farm.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    with open(at("farm.json"), "w", encoding="utf-8") as f:
        json.dump({"rows": lines[2:]}, f, indent=2)


if __name__ == "__main__":
    main()
