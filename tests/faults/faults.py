#!/usr/bin/env python3
"""What becomes of runs when memory, disk or patience end: each leaves all of its files or none, and says why. Emits TAP.

    faults.py VENATION FAIL_ALLOC FAIL_WRITE [--every] [--only WORD] [--jobs N]

FAIL_ALLOC and FAIL_WRITE are the shims beside this file. By default the n-th call fails for the first n, the last, and some between; with --every
for every n of every run (two hundred thousand runs, some hours on two cores). --only: tests with that word in their names.
"""
import argparse
import concurrent.futures
import errno
import json
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

SMALL = """\
[leaf]
title = Small leaf
[growth]
kind = isogonic
initial_length = 8
final_length = 24
step = 4
[sources]
density = 0.03
birth_distance_sources = 3
birth_distance_veins = 3
[veins]
kill_distance = 2
[texture]
size = 32
"""
MANY = "[sweep]\nparams = small.ini\nveins.kill_distance = 2; 3; 4\n"
NETWORK = """\
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="x" for="node" attr.name="x" attr.type="double"/><key id="y" for="node" attr.name="y" attr.type="double"/>
<key id="m" for="graph" attr.name="margin" attr.type="string"/>
<graph edgedefault="directed"><data key="m">0,0 8,6 6,16 0,24 -6,16 -8,6</data>
<node id="a"><data key="x">0</data><data key="y">0</data></node><node id="b"><data key="x">0</data><data key="y">10</data></node>
<node id="c"><data key="x">0</data><data key="y">22</data></node><node id="d"><data key="x">5</data><data key="y">14</data></node>
<edge source="a" target="b"/><edge source="b" target="c"/><edge source="b" target="d"/></graph></graphml>
"""
LEAF = ("--size", "32", "--set", "growth.final_length=40", "--set", "growth.initial_length=20")

# name, arguments, what an earlier run in the same folder was called with. A new verb is one line more.
RUNS = [
    ("grow", ("grow", "small.ini"), ("grow", "small.ini", "--seed", "2")),
    ("frames", ("grow", "small.ini", "--every", "8", "--frames", "maps", "--maps", "height", "--set", "export.network=no"),
     ("grow", "small.ini", "--every", "5", "--maps", "none")),
    ("shape", ("shape", "small.ini", "--rig", "4", "--lod", "2"), ("shape", "small.ini", "--seed", "2")),
    ("animate", ("shape", "small.ini", "--formats", "glb", "--set", "pose.keyframes=0 blend=0; 2 blend=1"), ("grow", "small.ini")),
    ("network", ("shape", "hand.graphml", "--size", "32", "--formats", "obj,pov"), None),
    ("png", ("capture", "leaf.png", *LEAF, "--maps", "height"), ("capture", "leaf.png", *LEAF, "--maps", "none")),
    ("jpeg", ("capture", "leaf.jpg", *LEAF, "--maps", "none"), None),
    ("tiff", ("capture", "leaf.tif", *LEAF, "--maps", "none"), None),
    ("params", ("params", "veins"), None),
    ("refused", ("grow", "bad.ini"), None),
]
TIMEOUT = 60
# What GLib says of its own when it gets no memory for small pieces or locks.
GLIB = re.compile(r"\*\*\*MEMORY-ERROR\*\*\*: (.*GSlice: failed.*\n)?|GLib \(gthread-posix.c\): .*\n?")


def differ(left, wanted):
    """Where two trees differ, for a message."""
    left, wanted = left or {}, wanted or {}
    return "differing: " + " ".join(sorted(n for n in set(left) | set(wanted) if left.get(n) != wanted.get(n))[:6])


class Fault(Exception):
    pass


def check(good, *what):
    if not good:
        raise Fault(" ".join(str(w) for w in what))


# ---- inputs ----

def colour(x, y):
    """An elliptic leaf with light veins, its base below."""
    u, v = (x + 0.5 - 30) / 22, (y + 0.5 - 50) / 40
    if u * u + v * v > 1:
        return 250, 250, 248
    vein = abs(x + 0.5 - 30) < 1.5 or abs((y - 50 + abs(x + 0.5 - 30)) % 24 - 12) < 1.0
    return (150, 190, 110) if vein else (60 + x % 3, 110 + y % 3, 40)


def write_png(path, width, height):
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in colour(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


def write_tiff(path, width, height):
    """One deflated strip of RGB."""
    data = zlib.compress(bytes(c for y in range(height) for x in range(width) for c in colour(x, y)))
    tags = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 3, 8 + len(data)), (259, 3, 1, 8), (262, 3, 1, 2), (273, 4, 1, 8),
            (277, 3, 1, 3), (278, 3, 1, height), (279, 4, 1, len(data))]
    with open(path, "wb") as file:
        file.write(b"II*\0" + struct.pack("<I", 8 + len(data) + 6) + data + struct.pack("<HHH", 8, 8, 8) + struct.pack("<H", len(tags)) +
                   b"".join(struct.pack("<HHII", *tag) for tag in tags) + struct.pack("<I", 0))


def write_jpeg(path, width, height):
    """Baseline, grey, each block of 8 by 8 one value: the smallest encoder there is."""
    out, bits, held = bytearray(), 0, 0

    def put(value, length):
        nonlocal bits, held
        bits, held = bits << length | value, held + length
        while held >= 8:
            held -= 8
            byte = bits >> held & 255
            out.append(byte)
            if byte == 255:
                out.append(0)
    before = 0
    for y in range(0, height, 8):
        for x in range(0, width, 8):
            value = sum(colour(x + 4, y + 4)) // 3 - 128
            step, before = value - before, value
            size = abs(step).bit_length()
            put(size, 4)  # the table below has sizes 0 … 11 as codes of four bits
            if size:
                put(step if step > 0 else step + (1 << size) - 1, size)
            put(0, 1)  # end of block
    put((1 << (8 - held) % 8) - 1, (8 - held) % 8)

    def part(kind, data):
        return struct.pack(">BBH", 255, kind, len(data) + 2) + data
    with open(path, "wb") as file:
        file.write(b"\xff\xd8" + part(0xDB, b"\0" + b"\x08" + b"\1" * 63) + part(0xC0, struct.pack(">BHHBBBB", 8, height, width, 1, 1, 0x11, 0)) +
                   part(0xC4, b"\0" + bytes([0, 0, 0, 12] + [0] * 12) + bytes(range(12))) + part(0xC4, b"\x10" + bytes([1] + [0] * 15) + b"\0") +
                   part(0xDA, b"\1\1\0\0\x3f\0") + bytes(out) + b"\xff\xd9")


def write_inputs():
    for name, text in ("many.ini", MANY), ("small.ini", SMALL), ("bad.ini", SMALL + "colour = 3\n"), ("hand.graphml", NETWORK):
        with open(name, "w") as file:
            file.write(text)
    write_png("leaf.png", 60, 100)
    write_tiff("leaf.tif", 60, 100)
    write_jpeg("leaf.jpg", 64, 104)


# ---- runs ----

def tree(folder):
    """Every file and folder with its bytes; None: there is no such folder."""
    if not os.path.isdir(folder):
        return None
    found = {}
    for at, folders, names in os.walk(folder):
        for name in folders:
            found[os.path.relpath(os.path.join(at, name), folder) + "/"] = b""
        for name in names:
            with open(os.path.join(at, name), "rb") as file:
                found[os.path.relpath(os.path.join(at, name), folder)] = file.read()
    return found


def command(args, folder, threads=1):
    return [VENATION, *args] + ([] if args[0] == "params" else ["-o", os.path.join(folder, "out"), "--threads", str(threads)])


def run(args, folder, threads=1, **env):
    """Status, output and messages of a run in a folder of its own."""
    done = subprocess.run(command(args, folder, threads), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env={**os.environ, "LC_ALL": "C.UTF-8", **env}, timeout=TIMEOUT)
    return done.returncode, done.stdout, done.stderr.decode(errors="replace")


def calls(path):
    with open(path, "rb") as file:
        return struct.unpack("=Q", file.read(8))[0]


class Case:
    """A run, what it gives when nothing fails, and what was in its folder before."""

    def __init__(self, name, args, earlier, shim, threads=1, **env):
        self.name, self.args, self.threads = name, args, threads
        self.env = {**env, "LD_PRELOAD": shim}
        self.root = tempfile.mkdtemp(dir=".")
        self.old = os.path.join(self.root, "old")
        os.mkdir(self.old)
        if earlier:
            status, _, said = run(earlier, self.old)
            check(status == 0, "the earlier run:", said)
        self.before = tree(self.old)
        self.status, self.stdout, self.said = self.call("reference", 0)[:3]
        self.after, self.total = tree(os.path.join(self.root, "reference")), calls(os.path.join(self.root, "reference.count"))

    def call(self, name, at, mode="once"):
        folder, count = os.path.join(self.root, name), os.path.join(self.root, name + ".count")
        shutil.copytree(self.old, folder)
        with open(count, "wb") as file:
            file.write(bytes(8))
        try:
            return *run(self.args, folder, self.threads, **self.env, FAULT_AT=str(at), FAULT_MODE=mode, FAULT_COUNT=count), folder, count
        except subprocess.TimeoutExpired:
            raise Fault(f"{self.name}, call {at}: hangs")

    def fail(self, at, mode, told):
        """One run, in which call `at` fails. Returns whether it was reached."""
        status, stdout, said, folder, count = self.call(f"{at}-{mode}", at, mode)
        what = f"{self.name}, {' '.join(f'{k}={v}' for k, v in self.env.items() if k != 'LD_PRELOAD')} FAULT_MODE={mode} FAULT_AT={at}:"
        left, reached = tree(folder), calls(count) >= at
        shutil.rmtree(folder)
        os.unlink(count)
        whole = left == self.after
        check(whole or left == self.before, what, "half-written", status, said, differ(left, self.after))
        if status == self.status and stdout == self.stdout:
            check(whole, what, "exit status", status, "but nothing written", said)
            return reached
        check(status == 1, what, "exit status", status, said)
        # GLib has a say of its own where it gets no memory for small pieces; a run may fail while it tells, at its end, what it has done.
        lines = [line for line in GLIB.sub("", said).splitlines() if line]
        check(lines and lines[-1].startswith("venation: ") and (whole or len(lines) == 1), what, "says", repr(said))
        check(told(said), what, "says", repr(said))
        check(".venation-" not in said, what, "names the hidden folder", said)
        return reached


class Many(Case):
    """A sweep: each leaf and each file is whole or not there, and the next run makes what is missing."""

    def fail(self, at, mode, told):
        status, _, said, folder, count = self.call(f"{at}-{mode}", at, mode)
        what = f"{self.name}, {' '.join(f'{k}={v}' for k, v in self.env.items() if k != 'LD_PRELOAD')} FAULT_MODE={mode} FAULT_AT={at}:"
        left, reached = tree(folder), calls(count) >= at or status == 0  # two threads: not all runs have as many calls
        check(status == 0 and left == self.after or status == 1 and told(said) and said.splitlines()[-1].startswith("venation: "), what, status, repr(said))
        check(".venation-" not in said, what, "names the hidden folder", said)
        leaves = {"/".join(n.split("/")[:3]) + "/" for n in left if n.startswith("out/leaves/") and n != "out/leaves/"}
        wanted = {n: self.after[n] for n in self.after if n in left or any(n.startswith(leaf) for leaf in leaves)}
        check(left == wanted, what, "half there:", differ(left, wanted))
        status, _, said = run(self.args, folder)
        check(status == 0 and tree(folder) == self.after, what, "the run after it:", status, said, differ(tree(folder), self.after))
        shutil.rmtree(folder)
        os.unlink(count)
        return reached


def numbers(total, last=10):
    """The calls that fail: all, or the first and last and ever fewer between."""
    if EVERY:
        return range(1, total + 1)
    chosen, n = set(range(max(1, total - last), total + 1)), 1.0
    while n < total:
        chosen |= {int(n), total - int(n)}
        n = n * 1.6 + 1
    return sorted(chosen - {0})


def sweep(case, told, mode="once", last=10):
    check(case.total > 0, case.name, "no call was counted: is the shim loaded?")
    reached = list(POOL.map(lambda n: case.fail(n, mode, told), numbers(case.total, last)))
    check(all(reached), case.name, "calls that were not reached:", reached.count(False))
    shutil.rmtree(case.root)
    return f"{len(reached)} of {case.total} calls"


# ---- tests ----

def no_memory(said):
    # A thread needs memory for its stack and variables.
    return "out of memory" in said or "Cannot allocate memory" in said or "can't start a thread" in said or "creating thread" in said


def test_memory(name, args, earlier, mode):
    return sweep(Case(name, args, earlier, ALLOC), no_memory, mode)


def names_reason(number):
    reason = os.strerror(number)
    return lambda said: said.rstrip().endswith(reason) and ("out" in said.split(reason)[0])


def test_disk(name, args, earlier, kind, number, mode):
    last = 60 if kind == "r" else 10  # the files move into place: little of that may be left out
    return sweep(Case(name, args, earlier, WRITE, FAULT_KIND=kind, FAULT_ERRNO=str(number)), names_reason(number), mode, last)


def test_short(name, args, earlier):
    case = Case(name, args, earlier, WRITE, FAULT_KIND="w", FAULT_ERRNO="0")
    check(case.total > 0, name, "no call was counted: is the shim loaded?")
    for n in sorted({1, 1 + case.total // 3, case.total}):
        status, _, said, folder, _ = case.call(f"{n}", n, "on")
        check(status == 0 and tree(folder) == case.after, "a short write is not gone on with:", n, said)
    shutil.rmtree(case.root)


def test_threads():
    """With several threads the order of calls is chance, but no less clean."""
    case = Case("grow", RUNS[0][1], RUNS[0][2], ALLOC, threads=4)
    list(POOL.map(lambda n: case.fail(n, "on", no_memory), numbers(case.total)))
    shutil.rmtree(case.root)


def signalled(args, earlier, number, rounds):
    """Signals at random moments: all or nothing, and the next run finds the place clean."""
    root = tempfile.mkdtemp(dir=".")
    old, rest = os.path.join(root, "old"), {"env": {**os.environ, "LC_ALL": "C.UTF-8"}, "stdin": subprocess.DEVNULL}
    os.mkdir(old)
    check(run(earlier, old)[0] == 0, "the earlier run failed")
    whole = shutil.copytree(old, os.path.join(root, "whole"))
    begun = time.monotonic()
    check(run(args, whole)[0] == 0, "the run fails without a signal")
    length, before, after = time.monotonic() - begun, tree(old), tree(whole)
    records = {n for n in set(before) | set(after) if n.endswith(".json")}
    chance, killed = random.Random(f"{args} {number}"), 0
    for i in range(rounds):
        folder = shutil.copytree(old, os.path.join(root, str(i)))
        process = subprocess.Popen(command(args, folder, chance.choice((1, 2))), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **rest)
        time.sleep(chance.uniform(0, 1.1 * length))
        process.send_signal(number)
        said = process.communicate(timeout=TIMEOUT)[1].decode()
        left, status = tree(folder), process.returncode
        if number == signal.SIGKILL:
            visible = {n: b for n, b in left.items() if ".venation-" not in n}
            check(visible == before or visible == after or not records & set(visible), "round", i, "a record of a mixture")
        else:
            # -number: before the command minds signals, when nothing has been made
            check(status in (0, 128 + number, -number), "round", i, "exit status", status, said)
            check(left == after if status == 0 else left in (before, after), "round", i, "half-written, exit status", status, said, differ(left, after))
        killed += status != 0
        status, _, said = run(args, folder)
        check(status == 0 and tree(folder) == after, "round", i, "the run after it:", status, said, differ(tree(folder), after))
        shutil.rmtree(folder)
    shutil.rmtree(root)
    return f"{killed} of {rounds} runs were stopped"


def limited(size, args, folder):
    done = subprocess.run(command(args, folder), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)), timeout=TIMEOUT,
                          env={**os.environ, "LC_ALL": "C.UTF-8"})
    return done.returncode, done.stderr.decode()


def test_file_limit(args):
    """Files may not grow beyond a size: write and its kin fail as the kernel has it."""
    root = tempfile.mkdtemp(dir=".")
    for size in (0, 100, 1000, 1500, 2000, 4000, 10000, 40000):
        status, said = limited(size, args, root)
        if status == 0:
            shutil.rmtree(os.path.join(root, "out"))
        else:
            check(status == 1 and "File too large" in said, size, status, said)
            check(tree(root) == {}, size, "left", sorted(tree(root)))
    shutil.rmtree(root)


def test_full_disk(args):
    """A disk of so many kilobytes, in a name space of its own. Prints what is left on it: the folders' names."""
    script = ('mount -t tmpfs -o size=$2k none "$1" && cd "$1" && shift 2 && "$@"; status=$?; find . -mindepth 1 >&2; exit $status')
    folder, sizes = tempfile.mkdtemp(dir="."), (4, 16, 64, 128, 160, 200, 400)
    inputs = os.getcwd()
    for size in sizes:
        full = [os.path.join(inputs, a) if os.path.exists(a) else a for a in args]
        done = subprocess.run(["unshare", "-rm", "sh", "-c", script, "sh", os.path.abspath(folder), str(size), *command(full, "."), "--quiet"],
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=TIMEOUT,
                              env={**os.environ, "LC_ALL": "C.UTF-8"})
        said = done.stderr.decode().splitlines()
        if any("unshare" in line or "mount" in line for line in said):
            return "SKIP " + said[0]
        if done.returncode == 0:
            continue
        check(done.returncode == 1 and len(said) == 1 and said[0].endswith("No space left on device"), size, "kB:", done.returncode, said)
    os.rmdir(folder)
    return None


def test_folder_removed(args, rounds):
    """Someone removes the folder while the run is at work."""
    root = tempfile.mkdtemp(dir=".")
    begun = time.monotonic()
    check(run(args, root)[0] == 0, "the run fails")
    length, whole = time.monotonic() - begun, tree(root)
    shutil.rmtree(os.path.join(root, "out"))
    chance = random.Random(str(args))
    for i in range(rounds):
        process = subprocess.Popen(command(args, root), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   env={**os.environ, "LC_ALL": "C.UTF-8"})
        time.sleep(chance.uniform(0, length))
        shutil.rmtree(os.path.join(root, "out"), ignore_errors=True)
        said = process.communicate(timeout=TIMEOUT)[1].decode()
        check(process.returncode in (0, 1), "round", i, process.returncode, said)
        check(process.returncode == 0 or said.startswith("venation: ") and "No such file" in said, "round", i, said)
        check(process.returncode == 0 or not tree(os.path.join(root, "out")), "round", i, "left", tree(root))
        shutil.rmtree(os.path.join(root, "out"), ignore_errors=True)
    check(run(args, root)[0] == 0 and tree(root) == whole, "the run after it")
    shutil.rmtree(root)


def tests():
    for name, args, earlier in RUNS:
        yield f"memory: {name}", lambda a=args, e=earlier, n=name: test_memory(n, a, e, "once")
        yield f"memory: {name}, from then on", lambda a=args, e=earlier, n=name: test_memory(n, a, e, "on")
    yield "memory: grow, four threads", test_threads
    for name, args, earlier in RUNS:
        if args[0] == "params" or name == "refused":
            continue
        for kind, number, mode in ("ow", errno.ENOSPC, "once"), ("w", errno.ENOSPC, "on"), ("c", errno.EIO, "once"), ("r", errno.EIO, "once"):
            yield (f"disk: {name}, {kind} {errno.errorcode[number]} {mode}",
                   lambda a=args, e=earlier, n=name, k=kind, x=number, m=mode: test_disk(n, a, e, k, x, m))
        yield f"disk: {name}, short writes", lambda a=args, e=earlier, n=name: test_short(n, a, e)
    many = ("sweep", "many.ini", "--write", "svg network", "--quiet", "--cell")
    for mode in "once", "on":
        yield f"memory: sweep, {mode}", lambda m=mode: sweep(Many("sweep", (*many, "0"), None, ALLOC), no_memory, m)
    for kind, number, mode in ("ow", errno.ENOSPC, "once"), ("w", errno.ENOSPC, "on"), ("c", errno.EIO, "once"), ("r", errno.EIO, "once"):
        yield (f"disk: sweep, {kind} {errno.errorcode[number]} {mode}",
               lambda k=kind, x=number, m=mode: sweep(Many("sweep", (*many, "32"), None, WRITE, FAULT_KIND=k, FAULT_ERRNO=str(x)), names_reason(x), m))
    grow, frames, shape = (RUNS[i][1] for i in range(3))
    capture = next(args for name, args, _ in RUNS if name == "png")
    yield "disk: files may not grow", lambda: test_file_limit(grow)
    yield "disk: full, grow", lambda: test_full_disk(grow)
    yield "disk: full, shape", lambda: test_full_disk(shape)
    yield "disk: full, capture", lambda: test_full_disk(capture)
    for name, args in ("frames", frames), ("shape", shape), ("capture", capture):
        yield f"disk: folder removed, {name}", lambda a=args: test_folder_removed(a, 100 if EVERY else 10)
    for number in signal.SIGINT, signal.SIGTERM, signal.SIGKILL:  # sweeps: cli/test_sweep.py
        for name, args, earlier in [r for r in RUNS if r[1] in (grow, frames, shape, capture)]:
            yield f"signal: {number.name}, {name}", lambda a=args, e=earlier, x=number: signalled(a, e, x, 300 if EVERY else 12)


def main():
    global VENATION, ALLOC, WRITE, EVERY, POOL
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in "venation", "fail_alloc", "fail_write":
        parser.add_argument(name)
    parser.add_argument("--every", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=2)
    a = parser.parse_args()
    VENATION, ALLOC, WRITE, EVERY = os.path.abspath(a.venation), os.path.abspath(a.fail_alloc), os.path.abspath(a.fail_write), a.every
    chosen, bad = [t for t in tests() if a.only in t[0]], 0
    print(f"1..{len(chosen)}")
    home = os.getcwd()
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(a.jobs) as POOL:
        os.chdir(folder)
        write_inputs()
        for number, (name, test) in enumerate(chosen, 1):
            begun = time.monotonic()
            try:
                note = test() or ""
                skip = note.startswith("SKIP")
                print(f"ok {number} - {name}" + (f" # {note}" if skip else ""))
                note = "" if skip else note
            except (Fault, OSError, subprocess.SubprocessError) as fault:
                bad += 1
                note = str(fault)
                print(f"not ok {number} - {name}")
            print(f"# {note.strip()} {time.monotonic() - begun:.1f} s".replace("\n", " | "), flush=True)
        os.chdir(home)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
