#!/usr/bin/env python3
"""Do all models still come out as they did?

usage: snapshot.py VENATION PARAMS_DIR SNAPSHOT_FILE [--update] [--threads=N,…]

Grows every PARAMS_DIR/*.ini, made small by sizes.txt beside this script, with 1, 2 and 7 threads (or so many), and compares the network's hash,
that of the bent blade and the pixels of every map with SNAPSHOT_FILE: a line "model item hash" for each. Pixels, not file bytes, which depend on the
version of zlib. Speaks TAP. After a change that is meant to change leaves:

    tests/snapshot/snapshot.py build/src/venation params tests/snapshot/snapshot.txt --update
"""

import hashlib
import json
import os
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from concurrent.futures import ThreadPoolExecutor

THREADS = [1, 2, 7]
COMMON = ("texture.size=192", "texture.depth=16", "texture.exr=none", "texture.maps=all", "export.svg=no", "export.network=no")
CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}


def table(path, fields):
    """Lines of words, comments and empty lines left out."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as f:
        lines = [line.split("#", 1)[0].split() for line in f]
    return [line for line in lines if len(line) >= fields]


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def unfilter(kind, line, above, step):
    """One scanline of a PNG, in place (PNG specification, section 9)."""
    if kind == 1:
        for i in range(step, len(line)):
            line[i] = (line[i] + line[i - step]) & 255
    elif kind == 2:
        for i in range(len(line)):
            line[i] = (line[i] + above[i]) & 255
    elif kind in (3, 4):
        for i in range(len(line)):
            left = line[i - step] if i >= step else 0
            corner = above[i - step] if i >= step else 0
            guess = (left + above[i]) // 2 if kind == 3 else paeth(left, above[i], corner)
            line[i] = (line[i] + guess) & 255
    elif kind != 0:
        raise ValueError("unknown PNG filter %d" % kind)


def png_hash(path):
    """Hash of a PNG's size, format and pixels."""
    with open(path, "rb") as f:
        data = f.read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("%s is no PNG" % path)
    at, packed, header = 8, b"", b""
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if zlib.crc32(name + body) != struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0]:
            raise ValueError("%s: wrong checksum of %r" % (path, name))
        if name == b"IHDR":
            header = body
        elif name == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", header)
    if interlace:
        raise ValueError("%s is interlaced" % path)
    step = max(1, CHANNELS[colour] * depth // 8)
    size = (width * CHANNELS[colour] * depth + 7) // 8
    raw = zlib.decompress(packed)
    digest = hashlib.sha256(header)
    above = bytearray(size)
    for y in range(height):
        line = bytearray(raw[y * (size + 1) + 1:(y + 1) * (size + 1)])
        unfilter(raw[y * (size + 1)], line, above, step)
        digest.update(line)
        above = line
    return digest.hexdigest()[:16]


def run(command):
    """The record that a run prints."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError("venation failed with status %d: %s" % (done.returncode, done.stderr.strip()))
    return json.loads(done.stdout)


def grow(venation, params, model, overrides, threads):
    """Items and hashes of one run, grown and then shaped."""
    with tempfile.TemporaryDirectory(prefix="venation-snapshot-") as out:
        options = [os.path.join(params, model + ".ini"), "-o", out, "--name", model, "--quiet", "--json", "--seed", "1",
                   "--threads", str(threads)] + ["--set=" + o for o in COMMON + tuple(overrides)]
        items = {"network": run([venation, "grow"] + options)["network"]["hash"],
                 "shape": run([venation, "shape"] + options + ["--formats", "none", "--pose", "withered"])["shape"]["hash"]}
        for name in sorted(os.listdir(out)):
            if name.endswith(".png"):
                items[name[len(model) + 1:-4]] = png_hash(os.path.join(out, name))
        return items


def differences(want, got):
    names = sorted(set(want) | set(got))
    return ["%s: %s instead of %s" % (n, got.get(n, "nothing"), want.get(n, "nothing")) for n in names if want.get(n) != got.get(n)]


def check(venation, params, model, sizes, known, update):
    """Complaints about one model, what it came out as, and the seconds that one run took."""
    if model not in sizes:
        return ["params/%s.ini has no line in tests/snapshot/sizes.txt: add one with overrides that make it grow within 1.5 s, then run "
                "snapshot.py with --update" % model], {}, 0.0
    start = time.monotonic()
    first = grow(venation, params, model, sizes[model], THREADS[0])
    seconds = time.monotonic() - start
    wrong = []
    for threads in THREADS[1:]:
        wrong += ["%d threads, %s" % (threads, d) for d in differences(first, grow(venation, params, model, sizes[model], threads))]
    if not update:
        if model not in known:
            wrong.append("not in the snapshot yet: look at the model, then run snapshot.py with --update")
        else:
            wrong += differences(known[model], first)
    return wrong, first, seconds


def write(path, results):
    lines = ["# Made by tests/snapshot/snapshot.py --update: model, item, hash."]
    lines += ["%s %s %s" % (model, item, results[model][item]) for model in sorted(results) for item in sorted(results[model])]
    with open(path + ".new", "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    os.replace(path + ".new", path)


def main():
    update = "--update" in sys.argv
    for a in sys.argv[1:]:
        if a.startswith("--threads="):
            THREADS[:] = [int(n) for n in a[10:].split(",")]
    words = [a for a in sys.argv[1:] if a != "--update" and not a.startswith("--threads=")]
    if len(words) != 3 or any(w.startswith("-") for w in words):
        sys.stderr.write(__doc__)
        return 2
    venation, params, snapshot = words
    sizes = {w[0]: w[1:] for w in table(os.path.join(os.path.dirname(os.path.abspath(__file__)), "sizes.txt"), 1)}
    known = {}
    for model, item, value in (w[:3] for w in table(snapshot, 3)):
        known.setdefault(model, {})[item] = value
    models = sorted(n[:-4] for n in os.listdir(params) if n.endswith(".ini"))
    names = models + sorted(set(known if not update else ()) - set(models))

    def one(model):
        if model not in models:
            return ["is in the snapshot, but there is no params/%s.ini: run snapshot.py with --update" % model], {}, 0.0
        try:
            return check(venation, params, model, sizes, known, update)
        except (OSError, ValueError, KeyError, RuntimeError) as e:
            return [str(e)], {}, 0.0

    print("1..%d" % len(names))
    results, failed = {}, False
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        for i, (model, (wrong, items, seconds)) in enumerate(zip(names, pool.map(one, names)), 1):
            for w in wrong:
                print("# %s: %s" % (model, w))
            print("# %s: %.2f s\n%s %d %s" % (model, seconds, "not ok" if wrong else "ok", i, model), flush=True)
            failed |= bool(wrong)
            results[model] = items
    if update and not failed:
        write(snapshot, results)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
