#!/usr/bin/env python3
"""Leaves a minute of a sweep, and its memory.

    bench_sweep.py VENATION SWEEP [LEAVES]

Grows LEAVES (default 60) variants of SWEEP (species.ini) as a data set at 512 pixels, and a tenth as many with the full set of maps at 2048, on one thread and
on all; beside them the same leaves by `venation grow`, one after the other. Then 10 and 10 000 variants of a leaf that takes no time, for the peak memory.
Run it by hand on a machine that does nothing else; it prints and does not judge.
"""
import os
import re
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


def timed(command):
    """Seconds, and the peak memory of the process in MB."""
    began = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{' '.join(command)}: status {status}")
    return time.monotonic() - began, usage.ru_maxrss / 1024


def a_part(text, count):
    return re.sub(r"(?m)^count = \d+$", f"count = {count}", text)


def main():
    venation, sweep = map(os.path.abspath, sys.argv[1:3])
    leaves = int(sys.argv[3]) if len(sys.argv) > 3 else 60
    folder = os.path.dirname(sweep)
    with open(sweep, encoding="utf-8") as file:
        text = file.read()
    cores = os.cpu_count()
    print(f"{os.path.basename(sweep)}, {cores} processors\n")
    print("| leaf | threads | leaves | seconds | leaves a minute | peak MB |\n| --- | --- | --- | --- | --- | --- |")
    for what, options, count in (("512, data set", ["--size", "512", "--dataset"], leaves), ("2048, all maps", ["--size", "2048"], max(leaves // 10, 4))):
        rate = {}
        for threads in sorted({1, cores}):
            with tempfile.TemporaryDirectory() as out:
                name = os.path.join(folder, f".bench-{os.getpid()}.ini")
                with open(name, "w", encoding="utf-8") as file:
                    file.write(a_part(text, count))
                try:
                    seconds, peak = timed([venation, "sweep", name, "-o", out, "-q", "--threads", str(threads), *options])
                finally:
                    os.unlink(name)
            rate[threads] = count / seconds * 60
            print(f"| {what} | {threads} | {count} | {seconds:.1f} | {rate[threads]:.0f} | {peak:.0f} |", flush=True)
        print(f"| scaling | | | | {rate[cores] / rate[1]:.2f} times | |")
    for count in (10, 10000):
        with tempfile.TemporaryDirectory() as out:
            with open(f"{out}/tiny.ini", "w", encoding="utf-8") as file:
                file.write(TINY)
            with open(f"{out}/many.ini", "w", encoding="utf-8") as file:
                file.write(f"[sweep]\nparams = tiny.ini\nmode = sample\ncount = {count}\nseed = each\nwidth.exponent = uniform(2, 3)\n")
            seconds, peak = timed([venation, "sweep", f"{out}/many.ini", "-o", f"{out}/out", "-q", "--write", "none", "--cell", "32"])
            print(f"| tiny, nothing written | {cores} | {count} | {seconds:.1f} | {count / seconds * 60:.0f} | {peak:.0f} |", flush=True)


if __name__ == "__main__":
    main()
