#!/usr/bin/env python3
"""Sweeps: what they write, what they refuse, and that neither threads, shards nor kills change a byte. Emits TAP.

    test_sweep.py VENATION
"""
import csv
import glob
import hashlib
import json
import math
import os
import pty
import random
import re
import resource
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import time
import zlib

from command import *

LEAF = """\
[leaf]
title = Small leaf
[outline]
file = blade.svg
[growth]
kind = isogonic
initial_length = 20
final_length = 60
step = 4
[sources]
density = 0.01
birth_distance_sources = 4
birth_distance_veins = 4
[veins]
kill_distance = 2
[texture]
size = 64
"""
BLADE = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0,0 C-50,-20 -40,-80 0,-100 C40,-80 50,-20 0,0 Z"/></svg>\n'
GRID = """\
[sweep]
params = leaf.ini
veins.kill_distance = 1; 2; 4
veins.pattern = open | closed
seed = 1; 2
"""
PARAMS = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "params")


def sweep_file(text=GRID, name="many.ini"):
    write("leaf.ini", LEAF)
    write("blade.svg", BLADE)
    return write(name, text)


def sweep(*args, status=0):
    result = run("sweep", *args)
    same(result.status, status, f"exit status (stderr {result.err!r})")
    return result


def rows(folder):
    with open(os.path.join(folder, "manifest.jsonl"), encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def stop_at_random(args, moment):
    """Starts a sweep and kills it after so many seconds; True if it had not ended by then."""
    process = subprocess.Popen([VENATION, "sweep", *args], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment())
    try:
        process.wait(moment)
        return False
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True


# --- what it writes -------------------------------------------------------------------------------------------

def test_grid():
    sweep(sweep_file(), "-q")
    found = rows("out/many")
    same(len(found), 12)
    same([(r["veins.kill_distance"], r["veins.pattern"], r["seed"]) for r in found],
         [(d, p, s) for d in (1, 2, 4) for p in ("open", "closed") for s in (1, 2)])
    same({r["outcome"] for r in found}, {"grown"})
    same(len({r["variant"] for r in found}), 12, "different names")
    same(len({r["network_hash"] for r in found}), 12, "different leaves")
    for row in found:
        folder = os.path.join("out/many", row["folder"])
        for suffix in (".json", ".svg", ".graphml", "_base_color.png", "_vein_mask.exr"):
            if not os.path.getsize(f"{folder}/{row['variant']}{suffix}"):
                raise AssertionError(suffix)
        record = json.loads(open(f"{folder}/{row['variant']}.json", encoding="utf-8").read())
        same(record["network"]["nodes"], row["nodes"])
        same(record["network"]["hash"], row["network_hash"])
    for name in ("sheet.png", "sheet.svg", "index.html", "manifest.csv"):
        if not os.path.getsize(f"out/many/{name}"):
            raise AssertionError(name)
    same([n for n in os.listdir("out/many") if n.startswith(".")], [], "hidden folders")


def test_table_of_rows_says_the_same():
    sweep(sweep_file(), "-q", "--write", "none")
    with open("out/many/manifest.csv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    for cells, row in zip(table, rows("out/many"), strict=True):
        same(set(cells), set(row))
        for name, value in row.items():
            cell = cells[name]
            same(float(cell) if isinstance(value, (int, float)) else (cell or None), value, name)


def test_sheets_are_told():
    sweep_file("[sweep]\nparams = leaf.ini\nseed = from 1 to 3 by 1\n")
    small = ["--write", "none", "--set", "growth.final_length=22"]
    holds(sweep("many.ini", *small, "--cell", "32").err, "out/many: sheet.png, index.html, manifest.csv")
    holds(sweep("many.ini", *small, "--cell", "0", "--replace").err, "out/many: manifest.csv")
    sweep_file("[sweep]\nparams = leaf.ini\nmode = sample\ncount = 1201\nseed = each\nwidth.exponent = uniform(2, 3)\n", "large.ini")
    sweep("large.ini", *small, "--cell", "32", "--shard", "1/60", "-q")
    result = sweep("large.ini", *small, "--cell", "32", "--collect", status=3)
    same(sorted(n for n in os.listdir("out/large") if n.endswith(".png")), ["sheet-2.png", "sheet-3.png", "sheet.png"])
    holds(result.err, "out/large: sheet.png … sheet-3.png, index.html, manifest.csv")


def test_zip_and_sample():
    sweep(sweep_file("[sweep]\nparams = leaf.ini\nmode = zip\nveins.kill_distance = 1; 2; 4\nwidth.minimum = 0.5; 0.4; 0.3\n"), "-q", "--write", "none")
    same([(r["veins.kill_distance"], r["width.minimum"]) for r in rows("out/many")], [(1, 0.5), (2, 0.4), (4, 0.3)])
    sweep(sweep_file("[sweep]\nparams = leaf.ini\nmode = sample\ncount = 7\nseed = each\nveins.kill_distance = uniform(1, 4)\n", "some.ini"), "-q", "--write", "none")
    found = rows("out/some")
    same([r["seed"] for r in found], [1, 2, 3, 4, 5, 6, 7])
    same(all(1 <= r["veins.kill_distance"] <= 4 for r in found), True)
    same(len({r["veins.kill_distance"] for r in found}), 7)


def check_alone(folder, row, keys):
    """The variant grown by itself with what its row says."""
    alone = f"alone-{row['index']}"
    chosen = [word for key in keys for word in ("--set", f"{key}={row[key]}")]
    result = run("grow", "leaf.ini", "-q", "-o", alone, "--name", row["variant"], "--seed", str(row["seed"]), *chosen)
    same(result.status, 0, result.err)
    there = contents(os.path.join(folder, row["folder"]))
    del there["sweep.json"]
    same(files(alone), sorted(there))
    same(contents(alone) == there, True, f"{chosen}")


def test_alone_as_in_the_sweep():
    sweep(sweep_file(), "-q", "--cell", "0")
    check_alone("out/many", rows("out/many")[9], ("veins.kill_distance", "veins.pattern"))


def test_alone_as_in_the_sample():
    """The manifest has what was drawn to the last digit."""
    keys = {"veins.kill_distance": "uniform(1, 4)", "sources.density": "log-uniform(0.001, 0.02)", "width.exponent": "normal(2.5, 0.3)", "veins.pattern": "choice(open | closed)",
            "outline.file": "choice(blade.svg; other.svg)", "growth.step": "uniform(2, 5, 1)", "texture.lamina_colour": "choice(#35602b; #447a32; #86ad55)"}
    write("other.svg", BLADE.replace("-50", "-70"))
    for sequence in ("random", "halton"):
        text = f"[sweep]\nparams = leaf.ini\nmode = sample\ncount = 40\nsequence = {sequence}\nsample_seed = 5\nseed = each\n" + "".join(f"{k} = {v}\n" for k, v in keys.items())
        sweep(sweep_file(text), "-q", "--cell", "0", "-o", sequence, "--shard", "3/13")
        sweep("many.ini", "-q", "--cell", "0", "-o", sequence, "--collect", status=3)
        found = [row for row in rows(sequence) if row["outcome"] == "grown"]
        same([row["index"] for row in found], [2, 15, 28])
        for row in found:
            check_alone(sequence, row, keys)
            shutil.rmtree(f"alone-{row['index']}")


def test_what_is_written():
    for what, wanted in (("none", [".json"]), ("svg", [".json", ".svg"]), ("network", [".graphml", ".json", "_edges.csv", "_nodes.csv"])):
        sweep(sweep_file(), "-q", "-o", what, "--write", what, "--cell", "0")
        row = rows(what)[0]
        same(files(os.path.join(what, row["folder"])), sorted([row["variant"] + s for s in wanted] + ["sweep.json"]))
    sweep(sweep_file("[sweep]\nparams = leaf.ini\nveins.kill_distance = 2\n"), "-q", "-o", "mesh", "--write", "mesh,maps", "--maps", "opacity", "--cell", "0")
    row = rows("mesh")[0]
    same(os.path.exists(f"mesh/{row['folder']}/{row['variant']}.glb"), True)
    holds(run("sweep", "many.ini", "--write", "map").err, "--write map: must be none, or names out of maps svg network mesh")


def test_dry_run():
    result = sweep(sweep_file(), "--dry-run", "--cell", "0")
    same(len(result.out.splitlines()), 12)
    holds(result.out, "veins.kill_distance=4 veins.pattern=closed seed=2")
    holds(result.err, "12 variants of about ")
    same(os.path.exists("out"), False)
    lines = sweep("many.ini", "--dry-run", "-q", "--shard", "2/5").out.splitlines()
    same([int(line.split()[0]) for line in lines], [1, 6, 11])
    same(run("sweep", "many.ini", "--dry-run", "--collect").status, 2)


def test_dry_run_tells_why_its_leaf_fails():
    text = "[sweep]\nparams = leaf.ini\nmode = zip\nname = a; b; c\ngrowth.initial_length = 20; 90; 30\n"
    result = sweep(sweep_file(text), "--dry-run", status=3)
    holds(result.err, "3 variants; number 1, grown for a trial, failed")
    same(len(result.out.splitlines()), 3)
    told = sweep("many.ini", "--dry-run", "-o", "out", status=3).err.splitlines()[-1]
    holds(told, "venation: b: ")
    holds(sweep("many.ini", status=3).err, told)


def test_dry_run_on_a_terminal():
    """The first variants alone, and the estimate after them; in a pipe all, and the estimate before them."""
    sweep_file("[sweep]\nparams = leaf.ini\nseed = from 1 to 1000 by 1\n")
    master, slave = pty.openpty()
    done = subprocess.Popen([VENATION, "sweep", "many.ini", "--dry-run"], stdin=subprocess.DEVNULL, stdout=slave, stderr=slave, env=environment())
    os.close(slave)
    shown = b""
    while part := read_terminal(master):
        shown += part
    same(done.wait(TIMEOUT), 0)
    lines = shown.decode().splitlines()
    same([int(line.split()[0]) for line in lines[:20]], list(range(20)))
    holds(lines[20], "… and 980 more")
    holds(lines[-1], "1000 variants of about ")
    both = subprocess.run([VENATION, "sweep", "many.ini", "--dry-run"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment(), check=True)
    lines = both.stdout.decode().splitlines()
    same(len(lines), 1001)
    holds(lines[0], "1000 variants of about ")


def read_terminal(master):
    try:
        return os.read(master, 65536)
    except OSError:  # EIO: the other end is closed
        return b""


def test_dry_run_of_a_leaf_that_takes_long():
    """What is told is less than all will take, but something."""
    sweep_file("[sweep]\nparams = leaf.ini\nseed = from 1 to 60 by 1\n")
    told = sweep("many.ini", "--dry-run", "--threads", "1", "--set", "growth.final_length=20000").err
    found = re.search(r"^60 variants; number 30, grown for a trial, takes longer than 20 s \((\d+) % of it grown by then\): more than 20 min on 1 thread$", told, re.MULTILINE)
    if not found or int(found.group(1)) > 99:
        raise AssertionError(told)


def test_dry_run_leaves_nothing_behind():
    sweep_file()
    os.mkdir("trials")
    for number, times in ((signal.SIGINT, 1), (signal.SIGTERM, 1), (signal.SIGINT, 2)):
        process = subprocess.Popen([VENATION, "sweep", "many.ini", "--dry-run", "--set", "growth.final_length=400"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(TMPDIR=os.path.abspath("trials")))
        while process.poll() is None and not os.listdir("trials"):
            time.sleep(0.01)
        time.sleep(0.2)
        for _ in range(times):
            process.send_signal(number)
        process.communicate(timeout=TIMEOUT)
        same(process.returncode, 128 + number)
        same(os.listdir("trials"), [])
    same(os.path.exists("out"), False)
    result = run("sweep", "many.ini", "--dry-run", env=environment(TMPDIR="/dev/null/x"))
    same(result.status, 1)
    holds(result.err, "/dev/null")


# --- the paper's figure, and the README ---------------------------------------------------------------------------

def params_here():
    """A folder sweeps of one's own, with what params/sweeps has above it."""
    os.mkdir("sweeps")
    for name in os.listdir(PARAMS):
        if name != "sweeps":
            os.symlink(os.path.join(PARAMS, name), name)


def captions(name):
    """What a sheet says at each leaf: letter, labels and values."""
    with open(name, encoding="utf-8") as file:
        lines = re.findall(r'<text [^>]*text-anchor="middle">(.*?)</text>', file.read())
    return [" ".join(re.findall(r">([^<]+)<", line)) for line in lines]


def test_kill_distances_of_figure_9():
    sweep(f"{PARAMS}/sweeps/kill-distance.ini", "-q", "--size", "64", "--write", "none", "-o", "out")
    found = rows("out")
    same([(r["veins.kill_distance"], r["width.minimum"]) for r in found], [(40, 2), (20, 1.1), (10, 0.6), (5, 0.45), (1, 0.35)])
    same([c for c in captions("out/sheet.svg") if "kill distance" in c], [f"{letter} kill distance {d}" for letter, d in zip("abcde", (40, 20, 10, 5, 1))])
    nodes = [r["nodes"] for r in found]
    same(all(many > 1.2 * few for few, many in zip(nodes, nodes[1:])), True, f"the smaller the distance the more veins: {nodes}")


def test_dart_densities_of_figure_9():
    sweep(f"{PARAMS}/sweeps/dart-density.ini", "-q", "--size", "64", "--write", "none", "-o", "out")
    found = rows("out")
    same([r["sources.density"] for r in found], [0.00006, 0.0003, 0.006])
    same(captions("out/sheet.svg"), ["a 0.00006", "b 0.0003", "c 0.006"])
    nodes = [r["nodes"] for r in found]
    same(nodes[0] < nodes[1] < nodes[2], True, f"the more darts the more veins: {nodes}")


def test_sweep_files_in_the_readme():
    """Each block is a sweep file, of as many variants as the text or the lists say."""
    with open(os.path.join(os.path.dirname(PARAMS), "README.md"), encoding="utf-8") as file:
        blocks = [b for b in re.findall(r"(?ms)^```ini\n(.*?)^```$", file.read()) if "[sweep]" in b]
    params_here()
    numbers = []
    for i, block in enumerate(blocks):
        lines = sweep(write(f"sweeps/readme-{i}.ini", block), "--dry-run", "-q").out.splitlines()
        same([int(line.split()[0]) for line in lines], list(range(len(lines))))
        numbers.append(len(lines))
    same(numbers, [9, 500])


# --- training data ------------------------------------------------------------------------------------------------

def read_png(name):
    """Width, height and values of a grey or RGB PNG, row by row."""
    with open(name, "rb") as file:
        data = file.read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += length + 12
    step = depth // 8 * (3 if colour == 2 else 1)
    raw, stride, before, values = zlib.decompress(packed), width * step, bytes(width * step), []
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = (line[i - step] if i >= step else 0), before[i], (before[i - step] if i >= step else 0)
            p = (abs(b - c), abs(a - c), abs(a + b - 2 * c))
            paeth = a if p[0] <= p[1] and p[0] <= p[2] else b if p[1] <= p[2] else c
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        values += struct.unpack(f">{width}H", line) if depth == 16 else list(line)
        before = line
    return width, height, values


def region(annotation, height):
    """The pixels of a run-length encoded annotation: (x, y), runs down the columns, the first one outside."""
    runs, at, pixels = annotation["segmentation"]["counts"], 0, set()
    for k, length in enumerate(runs):
        if k % 2 == 1:
            pixels.update((i // height, i % height) for i in range(at, at + length))
        if length == 0 and k > 0:
            raise AssertionError("an empty run")
        at += length
    return pixels, at


def check_region(annotation, wanted, width, height):
    """It is of these very pixels, and so are its area and box."""
    found, size = region(annotation, height)
    same((annotation["segmentation"]["size"], size), ([height, width], width * height))
    same(found == wanted, True, f"{len(found)} pixels for {len(wanted)}, {len(found ^ wanted)} amiss")
    xs, ys = [x for x, _ in wanted], [y for _, y in wanted]
    same((annotation["area"], annotation["bbox"]), (len(wanted), [min(xs), min(ys), max(xs) + 1 - min(xs), max(ys) + 1 - min(ys)]))
    same(annotation["iscrowd"], 0)


def shoelace(ring):
    points = list(zip(ring[::2], ring[1::2]))
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1]))) / 2


def check_annotations(split):
    with open(f"out/many/dataset/annotations/{split}.json", encoding="utf-8") as file:
        coco = json.loads(file.read())
    same([c["name"] for c in coco["categories"]], ["lamina", "areole", "vein"])
    same(sorted(i["file_name"] for i in coco["images"]), sorted(os.listdir(f"out/many/dataset/images/{split}")))
    if sum(a["category_id"] == 2 for a in coco["annotations"]) < 10:
        raise AssertionError("hardly any areoles: the test shows nothing")
    same(len({a["id"] for a in coco["annotations"]}), len(coco["annotations"]), "different numbers")
    small, thin, least = 0, 0, math.inf
    for image in coco["images"]:
        marks = [a for a in coco["annotations"] if a["image_id"] == image["id"]]
        same([a["category_id"] for a in marks], [1] + [2] * (len(marks) - 2) + [3])
        masks = {}
        for kind in ("images", "lamina", "vein", "order", "areole"):
            width, height, masks[kind] = read_png(f"out/many/dataset/{kind}/{split}/{image['file_name']}")
            same((width, height), (image["width"], image["height"]))
        lamina, areoles, vein = marks[0], marks[1:-1], marks[-1]
        ring = lamina["segmentation"][0]
        same(all(0 <= v <= width for v in ring), True)
        same(abs(shoelace(ring) - lamina["area"]) <= 0.02 * lamina["area"] + 2, True, f"area {lamina['area']} of {shoelace(ring)}")
        xs, ys = ring[::2], ring[1::2]
        for found, wanted in zip(lamina["bbox"], (min(xs), min(ys), max(xs) - min(xs), max(ys) - min(ys))):
            same(abs(found - wanted) < 1, True, "box")
        same(abs(lamina["area"] - sum(masks["lamina"]) / 255) < 0.01 * lamina["area"], True, "lamina")
        # Veins are where there is an order, which thin veins have where they cover too little of the pixel to be seen by that.
        ordered = {(i % width, i // width) for i, v in enumerate(masks["order"]) if v}
        check_region(vein, ordered, width, height)
        thin += sum(masks["vein"][y * width + x] < 128 for x, y in ordered)
        # Areoles are the map's, all but small ones.
        wanted = {}
        for i, v in enumerate(masks["areole"]):
            wanted.setdefault(v, set()).add((i % width, i // width))
        wanted.pop(0)
        same([a["label"] for a in areoles], sorted(label for label, pixels in wanted.items() if len(pixels) >= 16))
        for a in areoles:
            check_region(a, wanted[a["label"]], width, height)
        small += len(wanted) - len(areoles)
        least = min([least] + [a["area"] for a in areoles])
    if small == 0 or thin == 0:
        raise AssertionError("no small areoles or no thin veins: the test shows nothing")
    return {i["file_name"] for i in coco["images"]}, least


DATASET = "[sweep]\nparams = leaf.ini\nmode = sample\ncount = 10\nseed = each\nveins.kill_distance = uniform(1, 2)\n"


def test_dataset():
    sweep(sweep_file(DATASET), "-q", "--dataset", "--size", "112", "--validation", "0.4")
    (train, least), (val, other) = check_annotations("train"), check_annotations("val")
    same(min(least, other), 16, "the smallest areole told: the test sees where they begin")
    same((len(train | val), len(train & val)), (10, 0))
    same(bool(train) and bool(val), True, "both have some")
    holds(open("out/many/dataset/README.txt", encoding="utf-8").read(), f"{len(train)} to train with, {len(val)} to validate")
    for i in (1, 2, 3):
        sweep("many.ini", "-q", "--dataset", "--size", "112", "--shard", f"{i}/3", "-o", "shards")
    sweep("many.ini", "-q", "--dataset", "--size", "112", "--validation", "0.4", "-o", "shards", "--collect")
    same(contents("shards") == contents("out/many"), True, "three shards")


def write_png(name, width, height, pixel):
    """RGB; pixel(x, y) gives the three."""
    lines = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y)) for y in range(height))
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return write(name, b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def test_dataset_of_a_blade_with_holes():
    """A scan of a leaf with two holes: its lamina is its pixels, without those in the holes."""
    def pixel(x, y):
        holes = (x - 70) ** 2 + (y - 90) ** 2 < 14 ** 2 or (x - 125) ** 2 + (y - 140) ** 2 < 9 ** 2
        blade = ((x - 100) / 60) ** 2 + ((y - 120) / 95) ** 2 < 1 or (abs(x - 100) < 3 and 200 < y < 232)
        return (40, 90, 30) if blade and not holes else (245, 243, 240)
    write_png("scan.png", 200, 240, pixel)
    same(run("capture", "scan.png", "-q", "-o", "captured").status, 0)
    write("captured/many.ini", "[sweep]\nparams = scan.ini\nseed = 1; 2\n")
    sweep("captured/many.ini", "-q", "--dataset", "--size", "160", "--validation", "0", "--cell", "0")
    with open("out/many/dataset/annotations/train.json", encoding="utf-8") as file:
        coco = json.load(file)
    for image in coco["images"]:
        width, height, mask = read_png(f"out/many/dataset/lamina/train/{image['file_name']}")
        blade = {(i % width, i // width) for i, v in enumerate(mask) if v >= 128}
        lamina = [a for a in coco["annotations"] if a["image_id"] == image["id"] and a["category_id"] == 1]
        same(len(lamina), 1)
        check_region(lamina[0], blade, width, height)
        # The test sees holes: background that no way leads to from the edge of the image.
        outside, todo = {(0, 0)}, [(0, 0)]
        while todo:
            x, y = todo.pop()
            near = {(x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)) if 0 <= x + dx < width and 0 <= y + dy < height} - blade - outside
            outside |= near
            todo += near
        inside = width * height - len(outside) - len(blade)
        same(0.02 < inside / len(blade) < 0.08, True, f"{inside} pixels in holes, {len(blade)} of the blade")


def test_dataset_parts_by_seed():
    sweep(sweep_file("[sweep]\nparams = leaf.ini\nseed = from 1 to 8 by 1\nveins.kill_distance = 1; 2\n"), "-q", "--dataset", "--size", "32", "--cell", "0")
    side = {}
    for split in ("train", "val"):
        for name in os.listdir(f"out/many/dataset/images/{split}"):
            side.setdefault(re.search(r"seed-(\d+)", name).group(1), set()).add(split)
    same(len(side), 8)
    same({len(s) for s in side.values()}, {1}, "leaves of one seed are on one side")


def test_training_leaves_grow():
    """A small leaf of each row of species.csv: grown, hardly a source given up, veins all over the blade and no more of them than there is room for."""
    length, distance = 280, 7
    os.mkdir("sweeps")
    os.symlink(f"{PARAMS}/outlines", "outlines")
    write("sweeps/all.ini", f"[sweep]\nparams = {PARAMS}/kill-distance.ini\nmode = zip\ntable = {PARAMS}/sweeps/species.csv\n")
    sweep("sweeps/all.ini", "-q", "--cell", "0", "--dataset", "--size", "64", "--set", f"growth.final_length={length}", "--set", f"sources.birth_distance_sources={distance}",
          "--set", f"sources.birth_distance_veins={distance}")
    with open(f"{PARAMS}/sweeps/species.csv", encoding="utf-8") as file:
        wanted = list(csv.DictReader(line for line in file if not line.startswith("#")))
    found = rows("out/all")
    same(len(found), len(wanted))
    for row, leaf in zip(wanted, found):
        what = f"{leaf['variant']} ({row['outline.file']}, {row['growth.kind']}, {row['veins.pattern']})"
        same(leaf["outcome"], "grown", what)
        same(leaf["sources_given_up"] <= 0.01 * leaf["sources_reached"], True, f"{what}: {leaf['sources_given_up']} given up of {leaf['sources_reached']}")
        # Veins as far from one another as sources are: a length of 1 / distance or so in a unit of the blade; open ones are fewer.
        density = leaf["vein_length"] / leaf["blade_area"]
        same(0.1 / distance < density < 1.5 / distance, True, f"{what}: density {density}")
        split = "train" if os.path.exists(f"out/all/dataset/vein/train/{leaf['variant']}.png") else "val"
        _, _, vein = read_png(f"out/all/dataset/vein/{split}/{leaf['variant']}.png")
        same(sum(v > 0 for v in vein) > 64, True, f"{what}: hardly a vein in the mask")


# --- whichever way it is made -----------------------------------------------------------------------------------

def test_threads_shards_and_order():
    sweep(sweep_file(), "-q", "--threads", "1", "-o", "one")
    sweep("many.ini", "-q", "--threads", "2", "-o", "two")
    for part in (3, 1, 2):
        sweep("many.ini", "-q", "--shard", f"{part}/3", "-o", "shards")
    sweep("many.ini", "-q", "--collect", "-o", "shards")
    wanted = contents("one")
    same(contents("two") == wanted, True, "two threads")
    same(files("shards"), sorted(wanted))
    same(contents("shards") == wanted, True, "three shards")


def test_however_the_file_is_named():
    """By an absolute path, from elsewhere: no byte tells where the run began."""
    os.mkdir("there")
    for name in ("leaf.ini", "blade.svg", "many.ini"):
        sweep_file()
        os.rename(name, f"there/{name}")
    options = ["-q", "--set", "leaf.title=x", "--set", "outline.file=there/blade.svg"]
    sweep("there/many.ini", "-o", "relative", *options)
    sweep(os.path.abspath("there/many.ini"), "-o", "absolute", *options)
    same([n for n, data in contents("relative").items() if data != contents("absolute")[n]], [])
    # As the page says it is grown alone.
    row = rows("relative")[3]
    with open("relative/page/sweep.js", encoding="utf-8") as file:
        told = json.loads(file.read().removeprefix("venationSweep(").removesuffix(");\n"))
    os.chdir("there")
    chosen = [word for one in [*told["set"], *(f"{k['key']}={row[k['key']]}" for k in told["keys"] if k["key"] != "seed")] for word in ("--set", one)]
    same(run("grow", told["params"], "-q", "--seed", str(row["seed"]), "-o", "alone", "--maps", "none", *chosen).status, 0)
    same(json.loads(contents("alone")["leaf.json"])["network"]["hash"], row["network_hash"])


def kill_often(*options, wanted=10):
    """Kills runs at moments from beginning to end of a whole one, until so many were killed at work; one that was faster makes room for a new one."""
    began = time.monotonic()
    sweep("many.ini", "-q", "-o", "whole", *options)
    took, chance, killed = time.monotonic() - began, random.Random(7), 0
    for _ in range(20 * wanted):
        if killed == wanted:
            break
        moment = took * (killed + chance.uniform(0, 1)) / wanted
        if stop_at_random(["many.ini", "-q", "-o", "killed", *options], max(moment, 0.01)):
            killed += 1
        else:
            shutil.rmtree("killed")
            took *= 0.95  # the first run was slow, or the machine
        for d, folders, names in os.walk("killed/leaves"):  # whole or not there
            if not folders and d != "killed/leaves" and "sweep.json" not in names:
                raise AssertionError(f"{d}: half there: {names}")
    same(killed, wanted, "kills")
    sweep("many.ini", "-q", "-o", "killed", *options)
    same(files("killed"), files("whole"))
    same(contents("killed") == contents("whole"), True, "after kills")


def test_killed_at_any_moment():
    sweep_file()
    kill_often()


def test_data_set_killed_at_any_moment():
    sweep_file()
    kill_often("--dataset", "--size", "48")


def refused(options, *parts):
    """With one message."""
    told = sweep("many.ini", *options, status=3).err
    same(told.count("\n"), 1, told)
    for part in parts:
        holds(told, part)


def first_of(folder, suffix, number=0):
    return os.path.join(folder, rows(folder)[number]["folder"], rows(folder)[number]["variant"] + suffix)


def test_damaged_leaves_are_grown_anew():
    """What a power failure or somebody did to a finished leaf."""
    sweep(sweep_file(), "-q")
    before = contents("out/many")
    os.truncate(first_of("out/many", "_opacity.png", 2), 0)
    os.remove(first_of("out/many", ".svg", 7))
    write(f"out/many/{rows('out/many')[4]['folder']}/.notes", "x")  # a file manager's, as it were
    refused(["--collect"], "files of 2 leaves are not what they were", rows("out/many")[2]["folder"])
    holds(sweep("many.ini").err, "2 leaves grown, 10 were there")
    after = contents("out/many")
    same([after.pop(name) for name in list(after) if name.endswith(".notes")], [b"x"])
    same(after == before, True, "as before")


def test_data_set_is_made_of_what_was_written():
    """Of the same length, but other bytes."""
    options = ["--dataset", "--size", "32"]
    sweep(sweep_file(), "-q", *options)
    before = contents("out/many")
    mask = first_of("out/many", "_vein_mask.png", 3)
    with open(mask, "r+b") as file:
        file.seek(-20, os.SEEK_END)
        file.write(b"?")
    refused([*options, "--collect"], "files of 1 leaf are not", rows("out/many")[3]["folder"], "run the sweep again")
    holds(sweep("many.ini", *options).err, "1 leaf grown, 11 were there")
    same(contents("out/many") == before, True, "as before")


def test_other_options_take_no_leaves_away():
    sweep(sweep_file(), "-q")
    before = contents("out/many")
    cases = {"texture.maps": ["--write", "none"], "texture.size)": ["--size", "32"], "export.specimen": ["--dataset"], "width.exponent": ["--set", "width.exponent=3"],
             "veins.seeds": ["--set", "veins.seeds = 0.1,0"], "--cell": ["--cell", "64"]}
    for named, options in cases.items():
        for more in ([], ["--shard", "2/3"]):
            refused([*options, *more], "out/many: ", "of the leaves there are of other parameters or options (", named, "--replace")
    same(contents("out/many") == before, True, "nothing is touched")
    holds(sweep("many.ini", "--replace").err, "0 leaves grown, 12 were there")
    holds(sweep("many.ini", "--size", "32", "--replace").err, "12 leaves grown, 0 were there")
    holds(sweep("many.ini", "--size", "32").err, "0 leaves grown, 12 were there")


def test_the_command_that_collects():
    """As it is told after a part it does the rest."""
    write("my leaf's.ini", open(sweep_file(), encoding="utf-8").read())
    options = ["-o", "a b", "--set", "leaf.title=It's one", "--set", "width.exponent=3", "--dataset", "--validation", "0.5", "--size", "32"]
    for part in (1, 2):
        told = sweep("my leaf's.ini", *options, "--shard", f"{part}/2", "--threads", "2").err
    command = re.search(r"after the last one: venation (sweep .* --collect)$", told, re.MULTILINE).group(1)
    for left in ("--shard", "--threads"):
        lacks(command, left)
    result = run(*shlex.split(command))
    same(result.status, 0, result.err)
    sweep("my leaf's.ini", *options, "-q", "-o", "whole")
    same(contents("a b") == contents("whole"), True, "collected")


def peak(*args):
    """Most memory of a sweep that ended well, KiB."""
    process = subprocess.Popen([VENATION, "sweep", *args, "-q", "--threads", "2"], stdin=subprocess.DEVNULL, env=environment())
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    same(process.returncode, 0)
    return used.ru_maxrss


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


def test_memory_does_not_go_with_the_number():
    """Less than 1 KiB a leaf: a row of the manifest takes as much; and a sheet of large cells little more than one of few."""
    with open(VENATION, "rb") as file:
        if b"__asan_init" in file.read():
            raise Skip("a sanitizer keeps what is freed")
    for few, many, most, options in ((650, 1650, 1000, ["--write", "none", "--cell", "16"]), (150, 450, 600, ["--dataset", "--size", "16", "--cell", "0"]),
                                     (10, 160, 7000, ["--write", "none", "--cell", "320"])):
        used = []
        for count in (few, many):
            write("leaf.ini", TINY)
            write("many.ini", f"[sweep]\nparams = leaf.ini\nseed = from 1 to {count} by 1\n")
            what = ["many.ini", "-o", f"{count}-{most}", *options]
            whole = peak(*what)
            used.append(peak(*what, "--collect") if "320" in options else whole)  # growing takes more than such a sheet
        if used[1] - used[0] > most:
            raise AssertionError(f"{options}: {used} KiB for {few} and {many}")


def test_two_at_once():
    """Each leaves to the other what it has in hand, and the bytes are those of one."""
    sweep_file(GRID.replace("seed = 1; 2", "seed = 1; 2; 3; 4"))
    longer = ["--set", "growth.final_length=120", "--threads", "1", "--dataset"]
    sweep("many.ini", "-q", "-o", "alone", *longer)
    both = [subprocess.Popen([VENATION, "sweep", "many.ini", *longer], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment()) for _ in range(2)]
    told = [one.communicate(timeout=TIMEOUT)[1].decode() for one in both]
    same([one.returncode for one in both], [0, 0], f"{told}")
    grown = sum(int(re.search(r"(\d+) lea", text).group(1)) for text in told)
    # Both may take one in the same moment, or the last that the other has in hand; more often where the machine lets one wait.
    if not 24 <= grown < 36:
        raise AssertionError(f"{grown} grown of 24: {told}")
    same(files("out/many"), files("alone"))
    same(contents("out/many") == contents("alone"), True, "two at once")


def test_two_of_different_options_at_once():
    """Begun in the same moment on a folder that is empty, or not there: one goes on, and the other is refused before it writes a byte."""
    sweep_file(GRID.replace("1; 2; 4", "2"))
    kinds = (["many.ini"], ["many.ini", "--set", "width.exponent=3"], ["many.ini", "--cell", "64"])
    alone = []
    for k, kind in enumerate(kinds):
        sweep(*kind, "--write", "none", "-q", "-o", f"alone-{k}")
        alone.append(contents(f"alone-{k}"))
    chance, won = random.Random(3), [0, 0]
    for i in range(20):
        pair = (0, 1 + i % 2)
        both = []
        for k in pair:
            both.append(subprocess.Popen([VENATION, "sweep", *kinds[k], "--write", "none", "-o", f"both-{i}"], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                         env=environment()))
            time.sleep(chance.choice((0, 0, 0.002, 0.01)))
        told = [one.communicate(timeout=TIMEOUT)[1].decode() for one in both]
        same(sorted(one.returncode for one in both), [0, 3], f"{kinds[pair[1]]}: {told}")
        winner = [one.returncode for one in both].index(0)
        won[winner] += 1
        same(told[1 - winner].count("\n"), 1, told)
        holds(told[1 - winner], f"both-{i}: ")
        same(contents(f"both-{i}") == alone[pair[winner]], True, f"the winner's leaves alone: {kinds[pair[1]]}")
    same(sum(won), 20, won)


def test_run_at_work_keeps_its_folder():
    """While it works one of other options is refused, with --replace too; one of the same options helps; one that is dead elsewhere is named."""
    sweep_file()
    longer = ["--set", "growth.final_length=200", "--threads", "1", "--write", "none"]
    process = subprocess.Popen([VENATION, "sweep", "many.ini", "-q", *longer], stdin=subprocess.DEVNULL, env=environment())
    while process.poll() is None and not (os.path.isdir("out/many") and any(glob.glob("out/many/.venation-*/.settled-*"))):
        time.sleep(0.01)
    hidden = [n for n in os.listdir("out/many") if n.startswith(".")]
    for more in ([], ["--replace"], ["--shard", "1/2"]):
        refused([*longer, "--set", "width.exponent=3", *more], "another run with other parameters, options or variants", *hidden)
    write("other.ini", GRID.replace("1; 2; 4", "1; 2; 3"))
    holds(sweep("other.ini", "-o", "out/many", *longer, status=3).err, "another run with other")
    sweep("many.ini", *longer, "-q")
    same(process.wait(TIMEOUT), 0)
    os.makedirs("out/many/.venation-far-away-7-abcdef/.claim-0123")
    os.makedirs("out/many/.venation-far-away-7-abcdef/.settled-0123")
    refused(longer, "another run with other", ".venation-far-away-7-abcdef", "remove that folder")
    os.rmdir("out/many/.venation-far-away-7-abcdef/.settled-0123")
    refused(longer, "another run with other", ".venation-far-away-7-abcdef", "remove that folder")
    shutil.rmtree("out/many/.venation-far-away-7-abcdef")
    sweep("many.ini", *longer, "-q")


def test_run_that_is_dead_elsewhere():
    """What a run on another machine had in hand is grown when all else is there, and its folder is named and kept."""
    sweep_file()
    for name in ("kill_distance-1_pattern-open_seed-1", "kill_distance-4_pattern-closed_seed-2"):
        os.makedirs(f"out/many/.venation-far-away-7-abcdef/{name}")
    os.makedirs("out/many/.venation-far-away-8-abcdef")
    result = sweep("many.ini", "--write", "none")
    holds(result.err, "12 leaves grown, 0 were there")
    holds(result.err, "out/many: 2 hidden folders are of other runs, at work or killed: .venation-far-away-7-abcdef, .venation-far-away-8-abcdef; remove")
    shutil.rmtree("out/many/.venation-far-away-7-abcdef")
    holds(sweep("many.ini", "--collect", "--write", "none").err, "1 hidden folder is of another run")
    lacks(sweep("many.ini", "--write", "none", "--shard", "1/2").err, "hidden folder")
    lacks(sweep("many.ini", "-q", "--write", "none").err, "hidden folder")
    # This machine's dead are swept away.
    dead = subprocess.Popen(["true"])
    dead.wait()
    os.makedirs(f"out/many/.venation-{os.uname().nodename}-{dead.pid}-abcdef/x")
    lacks(sweep("many.ini", "--write", "none").err, "2 hidden")
    same([n for n in os.listdir("out/many") if n.startswith(".")], [".venation-far-away-8-abcdef"])


def test_leaves_of_no_variant_are_kept_and_told():
    first = sweep(sweep_file(), "--write", "none")
    lacks(first.err, "of no variant")
    sweep_file(GRID.replace("1; 2; 4", "1; 2; 3") + "growth.initial_length = 20; 90\n")
    result = sweep("many.ini", "--write", "none", status=3)
    holds(result.err, "out/many: 12 leaves are of no variant of this sweep, and kept: leaves/kill_distance-1_pattern-closed_seed-1, ")
    holds(result.err, " …\n")
    os.makedirs("out/many/leaves/mine/notes")  # whose they are can't be told
    write("out/many/leaves/mine/notes/a.txt", "x")
    sweep_file(GRID.replace("1; 2; 4", "1; 3") + "growth.initial_length = 20; 90\n")
    holds(sweep("many.ini", "--write", "none", status=3).err, "out/many: 20 leaves are of no variant")  # 12, four of 2 that grew and four that did not
    same(len(os.listdir("out/many/leaves")), 12 + 12 + 1)
    same(len(os.listdir("out/many/failed")), 12)


def test_sums():
    """A reader can verify what is there by the manifest alone."""
    sweep(sweep_file(), "-q")
    for row in rows("out/many"):
        folder, lines, size = f"out/many/{row['folder']}", "", 0
        for name in sorted(set(os.listdir(folder)) - {"sweep.json"}):
            with open(f"{folder}/{name}", "rb") as file:
                data = file.read()
            lines += f"{hashlib.sha256(data).hexdigest()}  {name}\n"
            size += len(data)
        same((len(lines.splitlines()), size, hashlib.sha256(lines.encode()).hexdigest()), (row["files"], row["bytes"], row["sha256"]))
    command = "ls | grep -vx sweep.json | LC_ALL=C sort | xargs sha256sum | sha256sum"
    same(subprocess.run(command, shell=True, cwd=folder, stdout=subprocess.PIPE, check=True).stdout.decode().split()[0], row["sha256"])


def test_large_seeds():
    sweep(sweep_file("[sweep]\nparams = leaf.ini\nseed = 9007199254740989; 9007199254740991; 9007199254740992\n"), "-q", "--write", "none")
    wanted = ["9007199254740989", "9007199254740991", "9007199254740992"]
    found = rows("out/many")
    same([str(r["seed"]) for r in found], wanted)
    same([r["variant"] for r in found], ["seed-" + s for s in wanted])
    same(len({r["network_hash"] for r in found}), 3)
    with open("out/many/manifest.csv", encoding="utf-8", newline="") as file:
        same([r["seed"] for r in csv.DictReader(file)], wanted)
    with open("out/many/page/0.js", encoding="utf-8") as file:
        page = file.read()
    for seed in wanted:
        holds(page, f'"{seed}"')
    record = json.loads(contents("out/many")["leaves/seed-9007199254740991/seed-9007199254740991.json"])
    same(str(record["seed"]), "9007199254740991")
    # As the page tells it to be grown alone.
    same(run("grow", "leaf.ini", "-q", "--seed", wanted[1], "--maps", "none", "-o", "alone").status, 0)
    same(json.loads(contents("alone")["leaf.json"])["network"]["hash"], found[1]["network_hash"])


def test_collecting_tells_how_far_it_is_and_stops():
    sweep(sweep_file("[sweep]\nparams = leaf.ini\nseed = from 1 to 400 by 1\n"), "-q", "--write", "none", "--cell", "32", "--set", "growth.final_length=22")
    again = ["many.ini", "--write", "none", "--cell", "32", "--set", "growth.final_length=22", "--collect"]
    before = contents("out/many")
    shown = run_on_terminal("sweep", *again)
    same(shown.status, 0)
    for phase in ("checking", "manifest", "sheet", "page"):
        if phase in ("checking", "sheet"):  # others may be over before they are told
            holds(shown.err, "collecting: " + phase)
    chance, stopped = random.Random(5), 0
    for _ in range(8):
        process = subprocess.Popen([VENATION, "sweep", *again], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment())
        time.sleep(chance.uniform(0.01, 0.3))
        process.send_signal(signal.SIGINT)
        told = process.communicate(timeout=TIMEOUT)[1].decode()
        if process.returncode not in (0, 128 + signal.SIGINT, -signal.SIGINT):  # the last: before it minds signals
            raise AssertionError(f"{process.returncode}: {told!r}")
        stopped += process.returncode == 128 + signal.SIGINT and "it was collecting" in told
        same(files("out/many"), sorted(before))
    if not stopped:
        raise AssertionError("never stopped while it collected")
    for _ in range(6):  # what a killed one leaves is hidden, and swept away by the next
        process = subprocess.Popen([VENATION, "sweep", *again], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment())
        time.sleep(chance.uniform(0.05, 0.3))
        process.kill()
        process.wait()
        same([name for name in files("out/many") if not name.startswith(".")], sorted(before))
    sweep(*again)
    same(contents("out/many") == before, True, "collected after all")


def test_interrupted():
    sweep_file()
    process = subprocess.Popen([VENATION, "sweep", "many.ini", "--set", "growth.final_length=200"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment())
    while process.poll() is None and not (os.path.isdir("out/many/leaves") and os.listdir("out/many/leaves")):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=TIMEOUT)
    same(process.returncode, 128 + signal.SIGINT)
    holds(told.decode(), "goes on from there")
    same([n for n in os.listdir("out/many") if n.startswith(".")], [], "hidden folders")


def test_does_only_what_is_missing():
    sweep(sweep_file(), "-q")
    first = rows("out/many")
    kept = f"out/many/{first[0]['folder']}/sweep.json"
    age = os.stat(kept).st_mtime_ns
    shutil.rmtree(f"out/many/{first[5]['folder']}")
    holds(sweep("many.ini").err, "1 leaf grown, 11 were there")
    same(os.stat(kept).st_mtime_ns, age)
    same(rows("out/many"), first)
    # Other parameters, another outline: other leaves.
    holds(sweep("many.ini", "--set", "width.exponent=3", "--replace").err, "12 leaves grown, 0 were there")
    write("blade.svg", BLADE.replace("-50", "-60"))
    refused(["--set", "width.exponent=3"], "12 of the leaves there are of other parameters or options (a file they name")
    holds(sweep("many.ini", "--set", "width.exponent=3", "--replace").err, "12 leaves grown, 0 were there")
    holds(sweep("many.ini", "--collect", status=3).err, "12 of the leaves there are of other parameters")


def test_failures_are_kept_apart():
    text = "[sweep]\nparams = leaf.ini\nmode = zip\ngrowth.initial_length = 20; 90; 30\n"
    result = sweep(sweep_file(text), status=3)
    holds(result.err, "2 leaves grown, 0 were there, 1 failed (out/many/failed)")
    found = rows("out/many")
    same([r["outcome"] for r in found], ["grown", "failed", "grown"])
    holds(found[1]["error"], "initial_length")
    same(os.listdir("out/many/failed"), [found[1]["variant"] + ".json"])
    same(len(os.listdir("out/many/leaves")), 2)
    holds(sweep("many.ini", status=3).err, "0 leaves grown, 2 were there, 1 failed")
    holds(sweep("many.ini", "--set", "growth.final_length=100", "--replace").err, "3 leaves grown")
    same(os.path.exists("out/many/failed"), False)


def test_full_disk_stops_the_run():
    small = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
    sweep_file()
    result = run("sweep", "many.ini", before=small)
    same(result.status, 1)
    holds(result.err, "out/many/leaves/")
    same(os.path.exists("out/many/failed"), False)


# --- what it refuses --------------------------------------------------------------------------------------------

def test_options_that_say_nothing():
    sweep_file("[sweep]\nparams = leaf.ini\ntexture.size = 32; 64\nexport.svg = yes; no\n")
    for args in (["--size", "64"], ["--write", "none"], ["--dataset"], ["--set", "texture.size = 16"]):
        check_refused(run("sweep", "many.ini", *args), 3, "many.ini gives ")
    os.makedirs("out/many/dataset")
    write("out/many/dataset/mine.txt", "x")
    sweep_file()
    same(run("sweep", "many.ini", "--dataset").status, 1)
    same(os.listdir("out/many/dataset"), ["mine.txt"])
    same(run("sweep", "many.ini", "--dry-run", "--shard", "20/30").status, 0)


def test_refusals():
    cases = {
        "veins.kil_distance = 1; 2": "veins.kill_distance",
        "veins.kill_distance =": "veins.kill_distance",
        "veins.kill_distance = 1; -2": "-2",
        "seed = from 1 to 1000000000 by 1": "1000000000",
        "mode = zip\nname = ../a; b\nveins.kill_distance = 1; 2": "would leave the folder",
        "mode = zip\nname = a; aux\nveins.kill_distance = 1; 2": "Windows",
        "veins.kill_distance = 1; 2\nseed = from 1 to 999999999 by 1": "many.ini:4: [sweep] seed: has 999999999 values",
        "veins.kill_distance = from 1 to 1000 by 1\nseed = from 1 to 1000 by 1\ngrowth.final_length = from 50 to 60 in 1000":
            "many.ini:3: [sweep] veins.kill_distance: has 1000 values, and 1000000000 variants are too many; there may be up to 999999999",
        "mode = sample\ncount = 1000000000\nseed = each": "many.ini:4: [sweep] count = 1000000000: must be a whole number from 1 to 999999999",
        "table = none.csv": "many.ini:3: [sweep] table: none.csv: can't read",
        "veins.kill_distance = from 1 to 4 in 2.5": "must be a whole one, 2 or more",
        "veins.kill_distance = from 1 to 2 by 1e-20": "too many values to tell apart",
        "mode = sample\ncount = 4\nveins.kill_distance = uniform(1, 1.0000000000000002)": "too narrow to tell values apart",
        "mode = sample\ncount = 4\nveins.kill_distance = normal(3, 1e-30)": "too narrow to tell values apart",
    }
    for lines, part in cases.items():
        sweep_file(f"[sweep]\nparams = leaf.ini\n{lines}\n")
        check_refused(run("sweep", "many.ini"), 3, "many.ini", part)
    check_refused(run("sweep", "nothing.ini"), 3, "nothing.ini")
    sweep_file()
    check_refused(run("sweep", "many.ini", "--set", "veins.kill_distance=3"), 3, "many.ini gives veins.kill_distance its values")
    for args in (["--shard", "0/3"], ["--shard", "4/3"], ["--shard", "3"], ["--shard", "1/2", "--collect"], ["--cell", "9999"], ["--cell", "5"], ["--dataset", "--validation", "2"], ["--picture", "leaf"], []):
        result = run("sweep", *(["many.ini"] if args else []), *args)
        same(result.status, 2, f"{args}: {result.err!r}")


if __name__ == "__main__":
    sys.exit(main(globals()))
