#!/usr/bin/env python3
"""Leaves a minute of a sweep, on one processor and on all, where the time goes, and memory.

    bench_sweep.py VENATION SWEEP [LEAVES] [--quick]

Grows LEAVES (default 60) variants of SWEEP (species.ini) as a data set at 512 pixels, and a fifth as many with the full set of maps at 2048, tied to one
processor and to all of them. Where perf can be used, a run on one processor tells what part of the time goes into what. Then 10 and 10 000 variants of
a leaf that takes no time, for the peak memory. --quick: a fifth of the leaves, and 10 and 1000 variants. Exit status 1 if the many take
5 MB more than the ten; of speed it does not judge: on a machine that does other things as well, go by the leaves a minute of processor time.

What bounds it: of a training leaf, painting takes a good half, most of it the exact union of strokes in each pixel, growing a quarter, and PNG files a twenty-fifth.
Of a full set at 2048 writing takes a good half, nearly all of it zlib's, and painting a fifth. Leaves share nothing but memory and caches.
"""
import collections
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

TINY = """\
[growth]
kind = isogonic
initial_length = 10
final_length = 12
step = 1
[sources]
density = 0.02
birth_distance_sources = 3
birth_distance_veins = 3
"""
MOST_MORE = 5  # MB: what a full sheet takes over one of ten; half a KiB a variant would be as much
WRITERS = ("deflate.c", "png.c", "exr.c", "encode.c", "file.c", "staged.c")
GROUPS = {"sim": "growing", "geom": "growing", "image": "painting", "batch": "sheet, masks, records"}


def timed(command, processors=None):
    """Seconds, processor seconds, and the peak memory of the process in MB."""
    began = time.monotonic()
    tie = (lambda: os.sched_setaffinity(0, processors)) if processors else None
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=tie)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{' '.join(command)}: status {status}")
    return time.monotonic() - began, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def functions(source):
    """What part of the work each function of the sources is. A name may be of several parts; shaping is not meant then, as nothing is shaped here."""
    groups = collections.defaultdict(set)
    for folder, _, names in os.walk(source):
        for name in names:
            if name.endswith((".c", ".h")):
                group = "writing files" if name in WRITERS else GROUPS.get(os.path.relpath(folder, source), "other")
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    for found in re.finditer(r"(?m)^[A-Za-z][\w \*]*?\b(\w+)\((?!.*\);).*$", file.read()):
                        groups[found[1]].add(group)
    for group in groups.values():
        if len(group) > 1:
            group.discard("other")
    return {name: " or ".join(sorted(group)) for name, group in groups.items()}


def shares(command, source, folder):
    """Part of the time by what it is spent on; None where perf can't be used."""
    if not shutil.which("perf"):
        return None
    data = os.path.join(folder, "perf.data")
    record = ["perf", "record", "-q", "-F", "500", "-o", data, "--", *command]
    if subprocess.run(record, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode:
        return None
    report = subprocess.run(["perf", "report", "-i", data, "--stdio", "-q", "--sort", "dso,symbol"], capture_output=True, text=True, check=False).stdout
    group, sums = functions(source), collections.Counter()
    for percent, library, symbol in re.findall(r"(?m)^\s*([\d.]+)%\s+(\S+)\s+\[.\]\s+(\w+)", report):
        key = "writing files" if re.match(r"libpng|libz|libOpenEXR", library) else group.get(symbol, "other")
        sums[key] += float(percent)
    for percent in re.findall(r"(?m)^\s*([\d.]+)%\s+\S+\s+\[k\]", report):
        sums["system"] += float(percent)
    return sums


def part_of(sweep, text, count, folder):
    """The sweep with so many variants, in a folder that looks like the sweep's own, as it names files beside it and above it."""
    home = os.path.dirname(os.path.abspath(sweep))
    above, here = os.path.dirname(home), os.path.join(folder, os.path.basename(home))
    for name in os.listdir(above):
        if name != os.path.basename(home):
            os.symlink(os.path.join(above, name), os.path.join(folder, name))
    shutil.copytree(home, here)
    name = os.path.join(here, os.path.basename(sweep))
    with open(name, "w", encoding="utf-8") as file:
        file.write(re.sub(r"(?m)^count = \d+$", f"count = {count}", text))
    return name


def rates(venation, sweep, text, what, options, count):
    every = sorted(os.sched_getaffinity(0))
    rate = {}
    with tempfile.TemporaryDirectory() as folder:
        name = part_of(sweep, text, count, folder)
        for used in sorted({1, len(every)}):
            with tempfile.TemporaryDirectory() as out:
                run = [venation, "sweep", name, "-o", out, "-q", "--threads", str(used), *options]
                seconds, processor, peak = timed(run, every[:used])
            rate[used] = count / seconds * 60
            print(f"| {what} | {used} | {count} | {seconds:.1f} | {rate[used]:.0f} | {count / processor * 60:.0f} | {peak:.0f} |", flush=True)
        if len(every) > 1:
            print(f"| {what}: scaling | {len(every)} | | | {rate[len(every)] / rate[1]:.2f} times | | |")
        with tempfile.TemporaryDirectory() as out:
            run = [venation, "sweep", name, "-o", os.path.join(out, "out"), "-q", "--threads", "1", *options]
            return shares(run, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../src"), out)


def main():
    words = [w for w in sys.argv[1:] if not w.startswith("--")]
    if len(words) < 2:
        sys.exit(__doc__)
    quick = "--quick" in sys.argv
    venation, sweep = map(os.path.abspath, words[:2])
    leaves = int(words[2]) if len(words) > 2 else 12 if quick else 60
    with open(sweep, encoding="utf-8") as file:
        text = file.read()
    print(f"{os.path.basename(sweep)}, {len(os.sched_getaffinity(0))} processors\n")
    print("| leaf | processors | leaves | seconds | leaves a minute | of processor time | peak MB |\n| --- | --- | --- | --- | --- | --- | --- |")
    parts = {}
    for what, options, count in (("512, data set", ["--size", "512", "--dataset"], leaves), ("2048, all maps", ["--size", "2048"], max(leaves // 5, 3))):
        parts[what] = rates(venation, sweep, text, what, options, count)
    peaks = []
    for count in (10, 1000 if quick else 10000):
        with tempfile.TemporaryDirectory() as out:
            with open(f"{out}/tiny.ini", "w", encoding="utf-8") as file:
                file.write(TINY)
            with open(f"{out}/many.ini", "w", encoding="utf-8") as file:
                file.write(f"[sweep]\nparams = tiny.ini\nmode = sample\ncount = {count}\nseed = each\nwidth.exponent = uniform(2, 3)\n")
            seconds, processor, peak = timed([venation, "sweep", f"{out}/many.ini", "-o", f"{out}/out", "-q", "--write", "none", "--cell", "32"])
            print(f"| tiny, nothing written | all | {count} | {seconds:.1f} | {count / seconds * 60:.0f} | {count / processor * 60:.0f} | {peak:.0f} |", flush=True)
            peaks.append(peak)
    for what, part in parts.items():
        if part:
            print(f"\n{what}: " + ", ".join(f"{name} {share:.0f} %" for name, share in part.most_common() if share >= 0.5))
        else:
            print(f"\n{what}: no perf, so no profile")
    if peaks[1] - peaks[0] > MOST_MORE:
        sys.exit(f"\nmemory goes with the number of variants: {peaks[0]:.1f} MB, then {peaks[1]:.1f}")


if __name__ == "__main__":
    main()
