#!/usr/bin/env python3
"""Runs under valgrind, most of them such as go wrong: no error of memory, and nothing lost on any way out. Emits TAP.

    memcheck.py VENATION FAIL_WRITE [--jobs N]

No suppressions: the libraries used are clean.
"""
import argparse
import concurrent.futures
import os
import shutil
import subprocess
import sys
import tempfile

import faults

VALGRIND = ["valgrind", "--quiet", "--error-exitcode=99", "--leak-check=full", "--num-callers=20", "--show-leak-kinds=definite,indirect,possible",
            "--errors-for-leak-kinds=definite,indirect,possible"]
SVG = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M 0,0 L 1{}"/></svg>'


def write_bad_inputs():
    texts = {
        "no-keys.ini": "poplar\n", "bad-value.ini": "[veins]\nkill_distance = much\n", "bad-range.ini": "[veins]\nkill_distance = -2\n",
        "crossed.ini": "[outline]\npath = M0,0 L10,10 L0,10 L10,0 Z\n", "bad-outline.ini": "[outline]\nfile = bad.svg\n",
        "open-outline.ini": "[outline]\nfile = open.svg\n", "no-outline.ini": "[outline]\nfile = none.svg\n",
        "bad-sources.ini": faults.SMALL.replace("[sources]", "[sources]\nfile = bad.csv"), "bad.csv": "1,2\n3\n",
        "bad.svg": SVG.format(",0 L 3,") [:-8], "open.svg": SVG.format(",1"), "bad.graphml": faults.NETWORK.replace('target="d"', 'target="e"'),
        "cut.graphml": faults.NETWORK[:400], "no-margin.graphml": faults.NETWORK.replace('key="m"', 'key="q"'), "empty.png": "",
        "bad-drawing.txt": "1 2\n3 four\n",
    }
    for name, text in texts.items():
        with open(name, "w") as file:
            file.write(text)
    for name in "leaf.png", "leaf.jpg", "leaf.tif":
        with open(name, "rb") as file:
            data = file.read()
        with open("cut-" + name, "wb") as file:
            file.write(data[:len(data) * 2 // 3])
        with open("head-" + name, "wb") as file:
            file.write(data[:20])
        with open("wrong-" + name, "wb") as file:
            file.write(data[:len(data) // 2] + bytes(b ^ 0x5A for b in data[len(data) // 2:len(data) // 2 + 40]) + data[len(data) // 2 + 40:])


# What goes wrong, and how the command ends.
REFUSED = [(3, ("grow", f"{name}.ini")) for name in
           ("no-keys", "bad-value", "bad-range", "crossed", "bad-outline", "open-outline", "no-outline", "bad-sources", "bad", "none")]
REFUSED += [(3, ("shape", f"{name}.graphml")) for name in ("bad", "cut", "no-margin", "none")]
REFUSED += [(3, ("capture", f"{what}-leaf.{kind}")) for what in ("cut", "head") for kind in ("png", "jpg", "tif")]
REFUSED += [(None, ("capture", f"wrong-leaf.{kind}", "--maps", "none", *faults.LEAF)) for kind in ("png", "jpg", "tif")]
REFUSED += [(3, ("capture", "empty.png")), (3, ("capture", "leaf.png", "--drawing", "bad-drawing.txt", *faults.LEAF)),
            (3, ("grow", "small.ini", "--set", "veins.pattern=shut")), (2, ("grow", "small.ini", "--evry", "3")), (2, ("grow",)),
            (3, ("shape", "small.ini", "--pose", "flat", "--set", "pose.rules=L9 rotate q 3"))]
# Writing that fails: the run, the kind of call (fail_write.c), and parts of the way.
FAILING = [(args, kind, part) for args in (faults.RUNS[0][1], faults.RUNS[1][1], faults.RUNS[2][1], faults.RUNS[5][1])
           for kind, part in (("o", 0.4), ("o", 0.95), ("w", 0.2), ("w", 0.6), ("w", 0.95), ("c", 0.5), ("r", 0.3), ("r", 0.9))]


def examine(wanted, args, **env):
    folder = tempfile.mkdtemp(dir=".")
    done = subprocess.run([*VALGRIND, *faults.command(args, folder, threads=2)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, env={**os.environ, "LC_ALL": "C.UTF-8", "G_SLICE": "always-malloc", **env})
    shutil.rmtree(folder)
    said = done.stderr.decode(errors="replace")
    if done.returncode == 99 or "==" in said:
        return said
    return None if wanted is None or done.returncode == wanted else f"exit status {done.returncode}, not {wanted}: {said}"


def fail_at(args, kind, part):
    case = faults.Case("memcheck", args, None, faults.WRITE, FAULT_KIND=kind)
    return examine(1, args, LD_PRELOAD=faults.WRITE, FAULT_KIND=kind, FAULT_AT=str(max(1, int(case.total * part))))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("venation")
    parser.add_argument("fail_write")
    parser.add_argument("--jobs", type=int, default=2)
    a = parser.parse_args()
    if not shutil.which("valgrind"):
        required = os.environ.get("VENATION_REQUIRE") == "all"
        print("1..1\nnot ok 1 - there is no valgrind" if required else "1..0 # SKIP there is no valgrind")
        return int(required)
    faults.VENATION, faults.WRITE = os.path.abspath(a.venation), os.path.abspath(a.fail_write)
    home, number, bad = os.getcwd(), 0, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        os.chdir(folder)
        faults.write_inputs()
        write_bad_inputs()
        jobs = [(" ".join(args), pool.submit(examine, 3 if name == "refused" else 0, args)) for name, args, _ in faults.RUNS]
        jobs += [(" ".join(args), pool.submit(examine, wanted, args)) for wanted, args in REFUSED]
        jobs += [(f"{' '.join(args)}, {kind} at {part}", pool.submit(fail_at, args, kind, part)) for args, kind, part in FAILING]
        print(f"1..{len(jobs)}")
        for number, (name, job) in enumerate(jobs, 1):
            problem = job.result()
            bad += problem is not None
            print(f"{'not ok' if problem else 'ok'} {number} - {name.replace('#', '')}")
            if problem:
                print("# " + "\n# ".join(problem.splitlines()), flush=True)
        os.chdir(home)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
