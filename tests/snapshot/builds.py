#!/usr/bin/env python3
"""Equal leaves from every build: other compilers, levels of optimisation, vector units, whole-program optimisation. Speaks TAP.

usage: builds.py [REFERENCE] [--all]

Each build grows and shapes every model of the snapshot, made small, and compares the network's hash, the bent blade's and the pixels of all maps
(snapshot.py). Then each file that `grow`, `shape`, `capture` and `sweep` write is compared byte by byte with what REFERENCE wrote, a venation that was
built before (default: the first build). By default two builds that differ most from each other and from a release build by gcc, and few files; --all: every
build and every model's files (some minutes), and then 64-bit ARM in an emulator (aarch64.sh; SYSROOT in the environment names its folder of libraries,
none leaves it out).
"""
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
NATIVE, LTO = ("-Dc_args=-march=native",), ("-Db_lto=true",)
# Compiler, level, further options, whether it belongs to the fast set.
BUILDS = [
    ("gcc", "0", (), True),
    ("clang", "3", NATIVE, True),
    ("gcc", "2", (), False),
    ("gcc", "3", NATIVE, False),
    ("gcc", "3", NATIVE + LTO, False),
    ("clang", "0", (), False),
    ("clang", "2", (), False),
    ("clang", "3", NATIVE + LTO, False),
]
FILES = ("--quiet", "--seed", "1", "--size", "64", "--set", "texture.exr=float", "--set", "texture.maps=all")
SWEEP = """\
[sweep]
params = %s
veins.kill_distance = 1; 4
sources.density = log-uniform(0.001, 0.003)
growth.initial_length = 60
growth.final_length = 150
seed = 1; 2
"""


class Failed(Exception):
    pass


def run(command, **env):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", env={**os.environ, **env}, check=False)
    if done.returncode:
        raise Failed("%s failed with status %d:\n%s" % (" ".join(command), done.returncode, done.stdout[-3000:]))
    return done.stdout


def build(folder, compiler, level, options):
    """The venation in it."""
    linker = {"CC_LD": "lld"} if compiler == "clang" and options[-1:] == LTO else {}
    run(["meson", "setup", folder, ROOT, "--buildtype=plain", "-Doptimization=" + level, "-Ddebug=false", "-Ddefault_library=static", *options],
        CC=compiler, **linker)
    run(["ninja", "-C", folder, "-j2", "src/venation"])
    return os.path.join(folder, "src", "venation")


def sizes(every):
    """Overrides that make models small, by model."""
    with open(os.path.join(HERE, "sizes.txt"), encoding="utf-8") as f:
        lines = [line.split("#", 1)[0].split() for line in f]
    return {w[0]: [x for o in w[1:] for x in ("--set", o)] for w in lines if w and (every or w[0] in ("cherry", "tertiary"))}


def files(venation, folder, every):
    """Hashes of all files that some runs write, by path."""
    for model, small in sizes(every).items():
        params, out = os.path.join(ROOT, "params", model + ".ini"), ["-o", os.path.join(folder, model)]
        run([venation, "grow", params, *small, *FILES, *out])
        run([venation, "shape", params, *small, *FILES, *out, "--pose", "withered", "--formats", "all", "--rig", "4", "--lod", "2"])
    if every:
        scan, grid = os.path.join(ROOT, "params", "scans", "grape.jpg"), os.path.join(folder, "grid.ini")
        run([venation, "capture", scan, *FILES, "-o", os.path.join(folder, "capture")])
        with open(grid, "w", encoding="utf-8") as f:
            f.write(SWEEP % os.path.join(ROOT, "params", "cherry.ini"))
        run([venation, "sweep", grid, "--quiet", "--size", "64", "--write", "maps,svg,network,mesh", "-o", os.path.join(folder, "sweep")])
    found = {}
    for at, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(at, name)
            with open(path, "rb") as f:
                found[os.path.relpath(path, folder)] = hashlib.sha256(f.read()).hexdigest()
    shutil.rmtree(folder)
    return found


def check(tmp, compiler, level, options, every, wanted):
    """Builds one, compares; returns its files."""
    folder = os.path.join(tmp, "build")
    venation = build(folder, compiler, level, options)
    run([sys.executable, os.path.join(HERE, "snapshot.py"), venation, os.path.join(ROOT, "params"), os.path.join(HERE, "snapshot.txt"), "--threads=1"])
    found = files(venation, os.path.join(tmp, "out"), every)
    shutil.rmtree(folder)
    wrong = sorted(n for n in set(found) | set(wanted or found) if wanted and found.get(n) != wanted.get(n))
    if wrong:
        raise Failed("%d of %d files differ: %s" % (len(wrong), len(found), " ".join(wrong[:12])))
    return found


def main():
    every = "--all" in sys.argv
    words = [a for a in sys.argv[1:] if a != "--all"]
    if len(words) > 1 or any(w.startswith("-") for w in words):
        sys.stderr.write(__doc__)
        return 2
    builds = [b for b in BUILDS if every or b[3]]
    arm = every and os.environ.get("SYSROOT", "/") != "none"
    bad, wanted = 0, None
    print("1..%d" % (len(builds) + arm), flush=True)
    with tempfile.TemporaryDirectory(prefix="venation-builds-") as tmp:
        if words:
            wanted = files(os.path.abspath(words[0]), os.path.join(tmp, "out"), every)
        for number, (compiler, level, options, _) in enumerate(builds, 1):
            name = " ".join([compiler, "-O" + level, *(o.split("=", 1)[1] if o.startswith("-Dc_args") else "-flto" for o in options)])
            if not shutil.which(compiler):
                required = os.environ.get("VENATION_REQUIRE") == "all" and not every
                bad += required
                print("%sok %d - %s # %sthere is no %s" % ("not " * required, number, name, "SKIP " * (not required), compiler), flush=True)
                continue
            begun = time.monotonic()
            try:
                found = check(tmp, compiler, level, options, every, wanted)
                wanted = wanted or found
                print("ok %d - %s\n# %d files, %.0f s" % (number, name, len(found), time.monotonic() - begun), flush=True)
            except Failed as e:
                bad = 1
                shutil.rmtree(os.path.join(tmp, "build"), ignore_errors=True)
                print("not ok %d - %s\n# %s" % (number, name, str(e).replace("\n", "\n# ")), flush=True)
        if arm:
            sysroot = [os.environ["SYSROOT"]] if os.environ.get("SYSROOT") else []
            done = subprocess.run([os.path.join(HERE, "aarch64.sh"), *sysroot], stdout=subprocess.PIPE, text=True, check=False)
            print("%s %d - aarch64" % ("not ok" if done.returncode else "ok", len(builds) + 1))
            print("".join("# " + line + "\n" for line in done.stdout.splitlines() if done.returncode or line.startswith("not ok")), end="")
            bad |= done.returncode != 0
    return bad


if __name__ == "__main__":
    sys.exit(main())
