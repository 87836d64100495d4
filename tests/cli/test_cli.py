#!/usr/bin/env python3
"""The venation command as users and scripts meet it: exit statuses, messages, output, interruption. Emits TAP.

    test_cli.py VENATION

Needs the standard library alone. What can't be tested here is skipped with its reason.
"""
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import time
import zlib

from command import *

# Small and quick to grow and to write.
SMALL = """\
[leaf]
title = Small leaf
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
# Grows in no time, but writes frames until it is stopped.
ENDLESS = """\
[veins]
max_steps = 3000
[growth]
kind = marginal
initial_length = 50
final_length = 100000
step = 0.02
[texture]
size = 64
"""


def check_set(setting, *parts):
    write("small.ini", SMALL)
    check_refused(run("grow", "small.ini", "--set", setting), 3, *parts)


def check_file(text, *parts):
    write("bad.ini", text)
    check_refused(run("grow", "bad.ini"), 3, *parts)


# --- verbs and options -------------------------------------------------------------------------------------------

def test_version():
    result = run("--version")
    same(result.status, 0)
    if not re.fullmatch(r"venation \d+\.\d+\.\d+\S*\n", result.out):
        raise AssertionError(result.out)


def test_help():
    overview = run("help")
    same(overview.status, 0)
    same(run("--help").out, overview.out)
    for verb in ("grow", "params", "help"):
        holds(overview.out, verb)
        result = run("help", verb)
        same(result.status, 0)
        same(result.err, "")
        holds(result.out, f"venation {verb}")
        same(run(verb, "--help").out, result.out, "VERB --help")
    longest = max(len(line) for line in run("help", "grow").out.splitlines())
    if longest > 100:
        raise AssertionError(f"a line of {longest} columns")


def test_usage_no_verb():
    result = run()
    same((result.status, result.out), (2, ""))
    holds(result.err, "Usage")


def test_usage_unknown_verb():
    check_refused(run("gorw", "x.ini"), 2, "gorw", "did you mean 'grow'?")
    check_refused(run("help", "parms"), 2, "did you mean 'params'?")
    check_refused(run("--verbose"), 2, "--verbose")
    check_refused(run("\x1b[31m"), 2)


def test_usage_grow():
    write("small.ini", SMALL)
    check_refused(run("grow"), 2, "missing")
    check_refused(run("grow", "small.ini", "other.ini"), 2)
    check_refused(run("grow", "small.ini", "--sed", "3"), 2, "did you mean --seed?")
    check_refused(run("grow", "small.ini", "-x"), 2)
    check_refused(run("grow", "small.ini", "--seed"), 2)
    for bad in ("", "x", "-3", "1.5", "0x", "0xg", "18446744073709551616", "1e3", " 1"):
        check_refused(run("grow", "small.ini", f"--seed={bad}"), 2, "--seed", "whole number")
    for bad in ("-1", "1025", "two"):
        check_refused(run("grow", "small.ini", "--threads", bad), 2, "--threads")
    for bad in ("-1", "0", "x", "4294967296"):
        check_refused(run("grow", "small.ini", "--every", bad), 2, f"--every {bad}: must be a whole number from 1 to 4294967295")
    check_refused(run("grow", "small.ini", "--every", "5", "--frames", "gif"), 2, "svg or maps")
    check_refused(run("grow", "small.ini", "--frames", "svg"), 2, "--every")
    check_refused(run("grow", "small.ini", "--every", "5", "--frames", "maps", "--maps", "none"), 2, "--frames maps")
    check_refused(run("grow", "small.ini", "--maps", "base_colour"), 3, "did you mean 'base_color'?")
    check_refused(run("grow", "small.ini", "--set", "veins.pattern"), 2, "section.key=value")
    for bad in ("a/b", "", ".hidden", "a\nb"):
        check_refused(run("grow", "small.ini", "--name", bad), 2, "--name")
    check_refused(run("grow", "small.ini", "-o", ""), 2, "--output")


def test_usage_params():
    check_refused(run("params", "veins.kil_distance"), 2, "did you mean 'veins.kill_distance'?")
    check_refused(run("params", "--format=jsn"), 2, "did you mean 'json'?")
    check_refused(run("params", "veins", "width"), 2)
    check_refused(run("params", "veins", "--format=man"), 2)
    check_refused(run("params", "--json", "--format=ini"), 2)


# --- bad input ---------------------------------------------------------------------------------------------------

def test_input_no_file():
    check_refused(run("grow", "poplar.ini"), 3, "poplar.ini", "No such file")
    os.mkdir("params")
    write("params/poplar.ini", SMALL)
    check_refused(run("grow", "poplar"), 3, "did you mean params/poplar.ini?")
    check_refused(run("grow", "poplar.ini"), 3, "did you mean params/poplar.ini?")
    check_refused(run("grow", "params"), 3, "Is a directory")


def test_input_unreadable_file():
    write("closed.ini", SMALL)
    os.chmod("closed.ini", 0)
    if os.access("closed.ini", os.R_OK):
        raise Skip("this user may read every file")
    check_refused(run("grow", "closed.ini"), 3, "closed.ini", "Permission denied")


def test_input_no_key_file():
    check_file(b"\x7fELF\0\0\0\rIHDR", "bad.ini", "not a text file")
    check_file(b"[leaf]\ntitle = \xff\n", "bad.ini:2", "UTF-8")
    check_file("\n" * (2 << 20), "1 MiB")
    check_refused(run("grow", "/dev/zero"), 3, "/dev/zero: larger than 1 MiB")
    check_refused(run("shape", "x.graphml", "--params", "/dev/zero"), 3, "/dev/zero: larger than 1 MiB")
    check_file("[veins\n", "bad.ini:1")
    check_file("[veins]\nkill distance 3\n", "bad.ini:2", "key = value")
    check_file("kill_distance = 3\n", "bad.ini:1", "section")


def test_input_unknown_names():
    check_file("[veins]\nkil_distance = 3\n", "bad.ini:2: [veins] kil_distance", "did you mean 'kill_distance'?")
    check_file("[sources]\nkill_distance = 3\n", "bad.ini:2", "[veins]")
    check_file("[vein]\n", "bad.ini:1", "did you mean [veins]?")
    check_file("[veins]\npattern = open\npattern = closed\n", "bad.ini:3", "line 2")
    check_set("veins.kil_distance=3", "--set", "did you mean 'veins.kill_distance'?")
    check_set("kill_distance=3", "did you mean 'veins.kill_distance'?")
    check_set("nothing.of_the_kind=3", "sections")


def test_input_values():
    check_file("[veins]\n\nkill_distance = -3\n",
               "bad.ini:3: [veins] kill_distance = -3: must be a number from 0 to 1e6 (segments)")
    for bad in ("nan", "inf", "-inf", "1e999", "0x10", "3x", "", "1,5"):
        check_set(f"veins.kill_distance={bad}", "veins.kill_distance", "must be a number from 0 to 1e6")
    check_set("veins.pattern=opne", "open or closed", "did you mean 'open'?")
    check_set("texture.vein_colour=green", "#rrggbb")
    check_set("veins.seeds=nan,0", "points")
    check_set("texture.size=64.5", "whole number")


def test_input_sizes():
    write("small.ini", SMALL)
    for bad in ("0", "1000000", "-5", "99999999999999999999"):
        check_refused(run("grow", "small.ini", "--size", bad), 3, f"venation: --size {bad}: must be a whole number from 16 to 16384")
    check_set("texture.size=0", "venation: --set texture.size=0: must be")


def test_input_maps():
    write("small.ini", SMALL)
    check_refused(run("grow", "small.ini", "--maps", "base_colour"), 3, "venation: --maps: no map is called 'base_colour'")
    check_set("texture.maps=base_colour,height", "venation: --set texture.maps: no map is called 'base_colour'")
    write("file.ini", SMALL + "maps = opacity base_colour\n")
    check_refused(run("grow", "file.ini"), 3, "venation: file.ini: [texture] maps: no map is called 'base_colour'")


def test_input_outline():
    check_set("outline.file=missing.svg", "missing.svg")
    check_set("outline.path=M0,0 L1,1 L1,", "--set outline.path: at character")
    check_set("outline.path=zebra", "outline")
    write("outline.svg", "no drawing at all")
    check_set("outline.file=outline.svg", "outline.svg")
    write("outline.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>")
    check_set("outline.file=outline.svg", "outline.svg", "Path > Object to Path")


def test_input_crossing_outline():
    check_set("outline.path=M0,0 L1,1 L1,0 L0,1 Z", "crosses or touches itself near 0.5,0.5")  # as much area left as right
    check_set("outline.path=M0,0 L4,0 L4,3 L1,3 L1,-1 L0,-1 Z", "crosses or touches itself near 1,0")
    check_set("outline.path=M0,0 L10,10 L10,0 L0,15 Z", "crosses or touches itself near 6,6")
    check_set("outline.path=M0,0 C3,0 3,4 0,4 C-3,4 -1,1 1.5,1 L1.5,-1 Z", "crosses or touches itself near 1.5,0.")
    write("outline.svg", "<svg><path id='outline' d='M0,0 L10,-10 L10,0 L0,-15 Z'/></svg>")
    check_set("outline.file=outline.svg", "crosses or touches itself near 6,-6")  # as the file has it


def test_input_teeth():
    write("teeth.ini", SMALL + "[outline]\npath = M0 0 L1 0 1 1 .8 1 .5 .2 .2 1 0 1z\nteeth_count = 40\nteeth_amplitude = 0.002\n")
    same(run("grow", "teeth.ini", "--maps", "none", "-o", "teeth").status, 0)
    check_refused(run("grow", "teeth.ini", "--set", "outline.teeth_amplitude=0.3"), 3, "the teeth run into each other or the blade near",
                  "teeth_amplitude")
    check_refused(run("grow", "teeth.ini", "--set", "outline.teeth_amplitude=0.6"), 3, "--set outline.teeth_amplitude=0.6", "0 to 0.5")


def test_input_empty_blade():
    check_set("outline.path=M0,0 Z", "outline")
    check_set("outline.path=M0,0 L0,1 L0,0 Z", "no area")
    check_set("outline.path=M0,0 L1,1 L2,2 Z", "no area")
    check_set("outline.path=M0,0 L1e-6,0.5 L0,1 Z", "--set outline.path: the path is a sliver")
    check_set("outline.path=M0,0 L1,500 L0,1000 Z", "sliver")


def test_grow_drawn_shapes():
    """What Inkscape saves, before Path > Object to Path and after."""
    write("small.ini", SMALL)
    for name, body in (("ellipse", '<ellipse id="path7" inkscape:label="outline" cx="9" cy="9" rx="3" ry="8"/>'),
                       ("label", '<path id="path7" inkscape:label="outline" d="M9 17 C 5 9 5 9 9 1 C 13 9 13 9 9 17"/>'),
                       ("polygon", '<polygon points="9,17 6,9 9,1 12,9"/><circle inkscape:label="tip" cx="9" cy="1" r="1"/>')):
        write(f"{name}.svg", f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape">'
                             f'<rect width="20" height="20"/>{body}</svg>')
        result = run("grow", "small.ini", "--set", f"outline.file={name}.svg", "--json", "--maps", "none", "-o", name)
        same(result.status, 0, result.err)
        leaf = json.loads(result.out)["leaf"]
        if not 55 < leaf["length"] < 65 or not 15 < leaf["width"] < 30:
            raise AssertionError((name, leaf))
    write("text.svg", '<svg><text id="outline">leaf</text></svg>')
    check_set("outline.file=text.svg", "text.svg", "Path > Object to Path")


def test_override_wins():
    write("drawn.svg", '<svg><polygon points="9,17 6,9 9,1 12,9"/></svg>')
    write("drawn.ini", SMALL + "[outline]\nfile = drawn.svg\n")
    write("path.ini", SMALL + "[outline]\npath = M0,0 L0.2,0.5 L0,1 L-0.2,0.5 Z\n")
    result = run("grow", "drawn.ini", "--set", "outline.path=M0,0 L0.2,0.5 L0,1 L-0.2,0.5 Z", "--json", "--maps", "none", "-o", "a")
    same(result.status, 0, result.err)
    same(json.loads(result.out)["parameters"]["outline"]["file"], "", "the file's outline")
    same(contents("a")["drawn.graphml"], (run("grow", "path.ini", "--maps", "none", "-o", "b"), contents("b")["path.graphml"])[1])
    same(run("grow", "path.ini", "--set", "outline.file=drawn.svg", "--maps", "none", "-o", "c").status, 0)
    check_refused(run("grow", "drawn.ini", "--set", "outline.path=M0,0 L1,1 L0,1 Z", "--set", "outline.file=drawn.svg"), 3,
                  "path are both given")
    write("both.ini", SMALL + "[outline]\nfile = drawn.svg\npath = M0,0 L1,1 L0,1 Z\n")
    check_refused(run("grow", "both.ini"), 3, "both.ini: [outline] file and path are both given")


def test_input_seeds():
    check_set("veins.seeds=0,0;0,0", "--set veins.seeds: two of the first nodes are at 0,0")
    check_set("veins.seeds=0,0.1;0,0.2;-0.0,0.1;0,0.3", "at 0,0.1")
    check_set("veins.seed_row=5", "--set veins.seed_row = 5", "veins.seeds has 1")
    write("row.ini", SMALL.replace("kill_distance", "seeds = 0,0.1; 0,0.1\nseed_row = 4\nkill_distance"))
    check_refused(run("grow", "row.ini"), 3, "row.ini: [veins] seeds: two of the first nodes are at 0,0.1")
    write("row.ini", SMALL.replace("kill_distance", "seeds = 0,0.1; 0,0.3\nseed_row = 4\nkill_distance"))
    same(run("grow", "row.ini", "--maps", "none", "-o", "row").status, 0)


def test_input_seeds_outside():
    check_set("veins.seeds=5,5", "seeds")


def test_input_sources_file():
    write("small.ini", SMALL)
    result = run("grow", "small.ini", "--set", "sources.placement=list", "--set", "sources.file=missing.csv")
    check_refused(result, 3, "missing.csv")
    listed = ("grow", "small.ini", "--set", "sources.placement=list", "--set", "sources.file=s.csv")
    for text, place in (("nan,2\n", "s.csv:1"), ("0,20\nl0,20\n", "s.csv:2"), ("1,2,3,4\n", "s.csv:1"), ("0,20,-1\n", "s.csv:1"),
                        ("0,20,1.5\n", "s.csv:1"), ("", "no source"), ("# nothing\nx,y\n", "s.csv:2"), ("0,500\n", "outside")):
        write("s.csv", text)
        check_refused(run(*listed), 3, place)
    write("s.csv", "x, y, step\n0, 20\n# a comment\n5;30;4\n")
    result = run(*listed, "--json", "--maps", "none")
    same(result.status, 0, result.err)
    same(json.loads(result.out)["sources"]["reached"], 2, "sources reached")
    shutil.rmtree("out")
    # a file that is given is used, unless another placement is asked for as well
    for options in (("small.ini", "--set", "sources.file=s.csv"), ("list.ini",)):
        write("list.ini", SMALL.replace("density", "file = s.csv\ndensity"))
        result = run("grow", *options, "--json", "--maps", "none", "-o", "list")
        same(result.status, 0, result.err)
        record = json.loads(result.out)
        same((record["sources"]["placed"], record["parameters"]["sources"]["placement"]), (2, "list"))
    write("list.ini", SMALL.replace("density", "file = s.csv\nplacement = darts\ndensity"))
    check_refused(run("grow", "list.ini"), 3, "list.ini: [sources] file is given, but placement is darts")
    result = run("grow", "list.ini", "--set", "sources.placement=darts", "--json", "--maps", "none", "-o", "list")
    same((result.status, json.loads(result.out)["parameters"]["sources"]["file"]), (0, ""))


def test_grow_bare():
    write("small.ini", SMALL)
    result = run("grow", "small.ini", "--set", "sources.density=0", "--json", "--maps", "none")
    same((result.status, json.loads(result.out)["run"]["end"]), (0, "no source ever found room"))
    holds(result.err, "1 node and 0 edges in ")


# --- growing -----------------------------------------------------------------------------------------------------

def test_grow():
    write("small.ini", SMALL)
    result = run("grow", "small.ini")
    same((result.status, result.out), (0, ""), result.err)
    found = files("out/small")
    for suffix in (".json", ".svg", ".graphml", "_base_color.png", "_opacity.png", "_height.png"):
        name = "small" + suffix
        if name not in found:
            raise AssertionError(f"no {name} among {found}")
    if any(name.startswith(".") for name in found):
        raise AssertionError(f"left over: {found}")
    holds(result.err, "Small leaf")
    holds(result.err, "out/small")
    if "\r" in result.err or "\x1b" in result.err:
        raise AssertionError(f"progress without a terminal: {result.err!r}")


def test_grow_quiet_json():
    write("small.ini", SMALL)
    title = "Ahorn \u00e4 \"x\""
    result = run("grow", "small.ini", "--json", "--quiet", "--seed", "0xff", f"--set=leaf.title={title}", "--name", "b")
    same((result.status, result.err), (0, ""))
    record = json.loads(result.out)
    with open("out/b/b.json", encoding="utf-8") as file:
        same(json.load(file), record, "the record's file")
    holds(result.out, "255")
    holds(json.dumps(record, ensure_ascii=False), json.dumps(title, ensure_ascii=False))
    lacks(result.out, os.getcwd())


def test_grow_same_bytes():
    write("small.ini", SMALL)
    same(run("grow", "small.ini", "-o", "a", "--threads", "1").status, 0)
    same(run("grow", "small.ini", "-o", "b/c/", "--threads", "3").status, 0)
    if contents("a") != contents("b/c"):
        raise AssertionError("equal runs differ")
    same(run("grow", "small.ini", "-o", "d", "--seed", "2").status, 0)
    if contents("a")["small.graphml"] == contents("d")["small.graphml"]:
        raise AssertionError("another seed, the same network")


def test_grow_maps():
    write("small.ini", SMALL)
    same(run("grow", "small.ini", "--maps", "height,opacity", "--size", "32", "--set", "texture.exr=none").status, 0)
    maps = [name for name in files("out/small") if name.endswith(".png") and "vein" not in name]
    same(maps, ["small_height.png", "small_opacity.png"])
    with open("out/small/small_height.png", "rb") as file:
        same(struct.unpack(">II", file.read(24)[16:]), (32, 32), "size")


def test_grow_maps_with_commas():
    write("small.ini", SMALL)
    for i, option in enumerate((("--maps", "height, opacity"), ("--set", "texture.maps=height,opacity"), ("--set", "texture.maps=height opacity"))):
        same(run("grow", "small.ini", *option, "-o", f"m{i}").status, 0)
        same(files(f"m{i}"), files("m0"))
    same(sum(name.endswith("height.png") for name in files("m0")), 1)


def test_grow_frames():
    write("small.ini", SMALL)
    same(run("grow", "small.ini", "--every", "5", "--maps", "none").status, 0)
    frames = files("out/small/frames")
    same(frames[0], "small_000000.svg", "the first frame")
    if "small_000005.svg" not in frames or "small_000010.svg" not in frames:
        raise AssertionError(frames)
    same(run("grow", "small.ini", "--every", "5", "--frames", "maps", "--maps", "opacity", "-o", "m").status, 0)
    if not any(name.startswith("small_000005") and name.endswith(".png") for name in files("m/frames")):
        raise AssertionError(files("m/frames"))


def test_grow_frames_share_scale():
    write("small.ini", SMALL)
    same(run("grow", "small.ini", "--every", "8", "--frames", "maps", "--maps", "height,age,distance").status, 0)
    for kind in ("height", "age", "distance"):
        scales = set()
        frames = [name for name in files("out/small/frames") if name.endswith(f"_{kind}.png")]
        for name in frames:
            with open(os.path.join("out/small/frames", name), "rb") as file:
                scales.add(tuple(re.findall(rb"tEXt(low|high)\0([-+.e0-9]+)", file.read())))
        if len(frames) < 3 or len(scales) != 1 or len(next(iter(scales))) != 2:
            raise AssertionError(f"{kind}: {len(frames)} frames, scales {scales}")


def test_grow_from_defaults_file():
    write("all.ini", run("params", "--format=ini").out)
    quick = ("growth.initial_length=20", "growth.final_length=60", "veins.max_steps=30", "texture.size=32")
    same(run("grow", "all.ini", *[f"--set={setting}" for setting in quick]).status, 0)


# --- what can go wrong while writing -----------------------------------------------------------------------------

def test_write_no_folder():
    write("small.ini", SMALL)
    write("file", "")
    for target in ("file", "file/below"):
        result = run("grow", "small.ini", "-o", target)
        check_refused(result, 1, "file", "Not a directory")
    with open("file", encoding="utf-8") as file:
        same(file.read(), "")
    os.makedirs("out/small/small.svg")
    result = run("grow", "small.ini")
    same(result.status, 1)
    holds(result.err, "small.svg")
    same(files("out"), [], "left over")


def test_write_file_limit():
    write("small.ini", SMALL)
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
    result = run("grow", "small.ini", before=limit)
    check_refused(result, 1, "out/small/small", "File too large")


def test_write_failure_keeps_old():
    write("small.ini", SMALL)
    same(run("grow", "small.ini").status, 0)
    old = contents("out")
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
    same(run("grow", "small.ini", "--seed", "2", before=limit).status, 1)
    if contents("out") != old:
        raise AssertionError("an earlier run's files changed")


def test_write_full_disk():
    write("small.ini", SMALL)
    os.mkdir("disk")
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=12k", "tmpfs", "disk"], check=False,
                                           stderr=subprocess.DEVNULL).returncode != 0:
        raise Skip("can't mount a small disk")
    try:
        result = run("grow", "small.ini", "-o", "disk/small")
        check_refused(result, 1, "disk/small", "No space left")
        same(os.listdir("disk"), [], "left over")
    finally:
        subprocess.run(["umount", "disk"], check=True)


def test_write_full_stdout():
    write("small.ini", SMALL)
    with open("/dev/full", "wb") as full:
        result = run("params", stdout=full)
        same(result.status, 1)
        holds(result.err, "No space left")
        same(run("grow", "small.ini", "--json", stdout=full).status, 1)


def start(*args):
    """A run to be stopped. SIGINT may be ignored by the one who runs the tests (in the background); undo that."""
    return subprocess.Popen([VENATION, *args], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            env=environment(), preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))


def wait_for_frame(process):
    """Until the run has written its first frame, so is in the midst of growing."""
    end = time.monotonic() + TIMEOUT / 2
    while time.monotonic() < end:
        if process.poll() is not None:
            raise AssertionError(f"ended by itself: {process.returncode} {process.stderr.read()!r}")
        if any(name.endswith(".svg") for name in files("work")):
            return
        time.sleep(0.02)
    raise AssertionError("no frame in time")


def check_stopped(number, status):
    os.makedirs("work")
    write("endless.ini", ENDLESS)
    process = start("grow", "endless.ini", "-o", "work/a/b", "--every", "3")
    try:
        wait_for_frame(process)
        process.send_signal(number)
        begun = time.monotonic()
        out, err = process.communicate(timeout=TIMEOUT / 2)
    finally:
        process.kill()
    same((process.returncode, out), (status, b""), f"status and stdout (stderr {err!r})")
    holds(err.decode(), "nothing was written")
    same(os.listdir("work"), [], "left over")
    if time.monotonic() - begun > 10:
        raise AssertionError("took too long to stop")


def test_stop_ctrl_c():
    check_stopped(signal.SIGINT, 130)


def test_stop_term():
    check_stopped(signal.SIGTERM, 143)


def test_stop_while_writing():
    os.makedirs("work")
    write("small.ini", SMALL)
    process = start("grow", "small.ini", "-o", "work/a", "--size", "2048")
    try:
        while process.poll() is None and not any(name.endswith((".png", ".svg", ".exr")) for name in files("work")):
            time.sleep(0.005)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=TIMEOUT / 2)
    finally:
        process.kill()
    if b" files, " in err: # told when all is written; what comes after that may still end the process by its default
        raise Skip("it had written all before it could be stopped")
    same(process.returncode, 143, f"exit status (stderr {err!r})")
    same(os.listdir("work"), [], "left over")


# --- terminal ----------------------------------------------------------------------------------------------------

def test_terminal_progress():
    write("small.ini", SMALL)
    result = run_on_terminal("grow", "small.ini", "--json")
    same(result.status, 0)
    json.loads(result.out)
    holds(result.err, "\r")
    holds(result.err, "\x1b[")
    holds(result.err, "\u2591")  # an empty cell of the bar
    holds(result.err, "%")


def test_terminal_plain():
    write("small.ini", SMALL)
    for env in (environment(NO_COLOR="1"), environment(TERM="dumb")):
        result = run_on_terminal("grow", "small.ini", env=env)
        same(result.status, 0)
        holds(result.err, "%")
        lacks(result.err, "\x1b")
    holds(run_on_terminal("grow", "small.ini", env=environment(NO_COLOR="")).err, "\x1b[")
    result = run_on_terminal("grow", "small.ini", env=environment(LC_ALL="C", NO_COLOR="1"))
    lacks(result.err.split("\n")[0], "\u2591")
    holds(result.err, "..")


def test_terminal_narrow():
    write("small.ini", SMALL)
    shown = run_on_terminal("grow", "small.ini", env=environment(NO_COLOR="1"), columns=24).err
    for line in shown.split("\n")[0].split("\r")[:-2]:  # then comes the summary
        if len(line) >= 24:
            raise AssertionError(f"wraps at 24 columns: {line!r}")


def test_terminal_quiet():
    write("small.ini", SMALL)
    same(run_on_terminal("grow", "small.ini", "--quiet").err, "")


# --- texts made from the tables ----------------------------------------------------------------------------------

def keys():
    return [p["key"] for p in json.loads(run("params", "--json").out)]


def test_params_json():
    parameters = json.loads(run("params", "--format=json").out)
    if len(parameters) < 20 or not all(p["doc"] and p["allowed"] and "default" in p for p in parameters):
        raise AssertionError(parameters)
    pattern = json.loads(run("params", "veins.pattern", "--json").out)
    same([(p["key"], p["choices"]) for p in pattern], [("veins.pattern", ["open", "closed"])])


def test_params_text():
    everything = run("params").out
    for key in keys():
        holds(everything, f"{key} =")
    longest = max(len(line) for line in everything.splitlines() if "=" not in line)
    if longest > 100:
        raise AssertionError(f"a line of {longest} columns")
    section = run("params", "veins").out
    holds(section, "veins.kill_distance = 1")
    lacks(section, "width.exponent =")
    lacks(section, "mesh.veins")  # a key of the section's name
    holds(run("params", "mesh.veins").out, "mesh.veins = yes")
    same(sorted(re.findall(r"^  (\S+) =", run("params", "file").out, re.M)), ["outline.file", "scan.file", "sources.file"])
    holds(run("params", "kill_distance").out, "veins.kill_distance = 1")


def test_params_ini():
    text = run("params", "--format=ini").out
    for key in keys():
        if not re.search(rf"^{key.split('.')[1]} =", text, re.M):
            raise AssertionError(f"no {key}")


def test_params_markdown():
    text = run("params", "--format=markdown").out
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    same(len(rows), len(keys()), "rows")
    for line in rows:
        same(len(re.split(r"(?<!\\)\|", line)), 6, f"cells of {line!r}")


def test_man():
    page = write("venation.1", run("params", "--format=man").out)
    with open(page, encoding="ascii") as file:
        source = file.read().replace("\\-", "-")
    for key in keys():
        holds(source, f"\\fB{key}\\fR")
    for option in re.findall(r"--[a-z]+", run("help", "grow").out):
        holds(source, option)
    need("man")
    for locale in ("C", "C.UTF-8"):
        env = environment(LC_ALL=locale, MANWIDTH="80", MANPAGER="cat")
        shown = subprocess.run(["man", "--warnings", "-l", page], env=env,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        same((shown.returncode, shown.stderr), (0, b""), f"man in {locale}")
        holds(shown.stdout.decode(errors="replace"), "veins.kill_distance")


def completions(line):
    program = 'source ./completion; COMP_LINE=$1 COMP_POINT=${#1}; _venation; printf "%s\\n" "${COMPREPLY[@]}"'
    done = subprocess.run(["bash", "--norc", "-c", program, "bash", line], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, check=False)
    same(done.stderr, b"", f"stderr of completing {line!r}")
    return done.stdout.decode().split()


def test_shape():
    write("small.ini", SMALL)
    done = run("shape", "small.ini", "--size", "64", "--lod", "2", "--rig", "4", "--set", "pose.keyframes=0 blend=0; 2 blend=1", "--json")
    same(done.status, 0)
    record = json.loads(done.out)["shape"]
    if record["triangles"] < 200 or record["levels"][0] >= record["triangles"]:
        raise AssertionError(record)
    wanted = {f"small{end}" for end in (".glb", ".obj", ".mtl", ".ply", ".pov", ".inc", ".json", "_lod1.glb", "_lod1.ply",
                                        "_rigged.glb", "_animated.glb", "_base_color.png")}
    found = set(files("out/small"))
    if not wanted <= found:
        raise AssertionError(wanted - found)
    same(json.loads(open("out/small/small.json", encoding="utf-8").read())["shape"], record)
    # the network that grow wrote gives the same leaf to the rounding of the file, and equal runs give equal bytes
    same(run("grow", "small.ini", "--maps", "none", "-o", "net").status, 0)
    for out in ("a", "b"):
        same(run("shape", "net/small.graphml", "--params", "small.ini", "--size", "64", "-o", out, "--threads", "1" if out == "a" else "2").status, 0)
    again = json.loads(open("a/small.json", encoding="utf-8").read())["shape"]
    if abs(again["veins"] - record["veins"]) > 2: # a vein may lie right at a limit
        raise AssertionError((again, record))
    for name in files("a"):
        same(open(f"a/{name}", "rb").read(), open(f"b/{name}", "rb").read(), name)


def png(name, width, height, pixel):
    """Writes an RGB image; pixel(x, y) gives its colour."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))
    return name


def leaf_colour(x, y, x0=60.0, y0=100.0, a=45.0, b=80.0):
    """An elliptic leaf with light veins, its base below."""
    u, v = (x + 0.5 - x0) / a, (y + 0.5 - y0) / b
    if u * u + v * v > 1:
        return (250, 250, 248)
    vein = abs(x + 0.5 - x0) < 1.5 or abs((y - y0 + abs(x + 0.5 - x0)) % 24 - 12) < 1.0
    return (150, 190, 110) if vein else (60 + x % 3, 110 + y % 3, 40)


CAPTURE = ("--size", "64", "--set", "growth.final_length=120", "--set", "growth.initial_length=40")


def test_capture():
    png("leaf.png", 120, 200, leaf_colour)
    done = run("capture", "leaf.png", *CAPTURE, "--json")
    same(done.status, 0)
    record = json.loads(done.out)
    area = math.pi * 45 * 80
    if abs(record["scan"]["area"] / area - 1) > 0.005:
        raise AssertionError(record["scan"])
    wanted = {"leaf.ini", "leaf.json", "leaf.svg", "leaf.graphml", "leaf_drawing.svg", "leaf_scan.png", "leaf_base_color.png"}
    if not wanted <= set(files("out/leaf")):
        raise AssertionError(wanted - set(files("out/leaf")))
    same(open("out/leaf/leaf_scan.png", "rb").read(), open("leaf.png", "rb").read(), "scan")
    # equal bytes with any number of threads
    same(run("capture", "leaf.png", *CAPTURE, "-o", "again", "--threads", "2").status, 0)
    for name in files("again"):
        same(open(f"again/{name}", "rb").read(), open(f"out/leaf/{name}", "rb").read(), name)
    # the folder can be moved, and grown and shaped from
    os.rename("out/leaf", "moved")
    grown = run("grow", "moved/leaf.ini", "--maps", "base_color", "-o", "grown", "--json")
    same(grown.status, 0)
    if json.loads(grown.out)["network"]["nodes"] <= record["network"]["nodes"]:
        raise AssertionError("nothing grew")
    same(run("shape", "moved/leaf.ini", "--formats", "glb", "-o", "shaped").status, 0)
    if "leaf.glb" not in files("shaped"):
        raise AssertionError(files("shaped"))
    # all at once
    same(run("shape", "leaf.png", *CAPTURE, "--formats", "glb", "-o", "once").status, 0)
    if "leaf.glb" not in files("once"):
        raise AssertionError(files("once"))


def test_capture_tells_veins():
    png("leaf.png", 120, 200, leaf_colour)
    write("veins.txt", "60 180\n60 100\n60 20\n\n60 120\n85 90\n\n60 100\n35 70\n")
    for more, parts in ((("--drawing", "veins.txt"), ("veins drawn: 1 primary, 2 secondary", "correct outline and veins")),
                        (("--set", "scan.veins=none"), ("without veins", "correct the outline and draw veins")),
                        (("--set", "veins.origin=lsystem", "--json"), ("veins by the L-system: 1 primary", "correct the outline with"))):
        done = run("capture", "leaf.png", *CAPTURE, "--maps", "none", *more)
        for part in parts:
            holds(done.err, part)
    same(json.loads(done.out)["lsystem"], {"preset": "pinnate"})


def test_capture_a_folder():
    check_refused(run("capture", "."), 2, ".: is a folder; capture takes one file at a time")
    os.mkdir("scans")
    check_refused(run("capture", "scans"), 3, "Is a directory")


def tiff(pages):
    """Grey pages of 8 × 8 pixels; True: a thumbnail of the one before."""
    out = b"II*\0" + struct.pack("<I", 8)
    for i, small in enumerate(pages):
        entries = [(254, 4, 1, int(small)), (256, 3, 1, 8), (257, 3, 1, 8), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1), (273, 4, 1, len(out) + 2 + 10 * 12 + 4), (277, 3, 1, 1),
                   (278, 3, 1, 8), (279, 4, 1, 64)]
        pixels = bytes(20 if 1 < x < 6 and 1 < y < 6 else 250 for y in range(8) for x in range(8))
        after = len(out) + 2 + 10 * 12 + 4 + 64
        out += struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *e) for e in entries) + struct.pack("<I", after if i + 1 < len(pages) else 0) + pixels
    return out


def test_capture_pages():
    for pages, note in (([False], None), ([False, True], None), ([False, True, False, False], "pages.tif: has 3 pages; the first is read")):
        with open("pages.tif", "wb") as f:
            f.write(tiff(pages))
        done = run("capture", "pages.tif", "--maps", "none", "--set", "export.svg=no")
        same(done.status, 0, done.err)
        if (" pages;" in done.err) != bool(note) or (note and note not in done.err):
            raise AssertionError((pages, done.err))


def test_capture_ragged():
    """Noise that makes fringes of the margin is told; a little is not."""
    for noise, ragged in ((6, False), (100, True)):
        chance = random.Random(7)
        grain = [[chance.uniform(-noise, noise) for _ in range(201)] for _ in range(301)]

        def shade(x, y):
            inside = ((x - 100) / 70) ** 2 + ((y - 150) / 130) ** 2 < 1
            value = max(0, min(255, round((110 if inside else 170) + grain[y][x])))
            return value, value, value

        png("noisy.png", 200, 300, shade)
        done = run("capture", "noisy.png", *CAPTURE, "--maps", "none", "-o", "noisy")
        same(done.status, 0, done.err)
        same("the outline is ragged" in done.err, ragged)


def test_tracing_as_outline():
    png("leaf.png", 120, 200, leaf_colour)
    write("blade.txt", "60 180\n90 160\n100 100\n60 20\n20 100\n\n50 120\n114 110\n114 90\n50 80\n")  # a lobe traced on its own
    done = run("capture", "leaf.png", *CAPTURE, "--maps", "none", "-o", "a", "--set", "outline.file=blade.txt", "--json")
    same(done.status, 0, done.err)
    same(json.loads(done.out)["scan"]["base"], [60, 180])
    write("apart.txt", "60 180\n90 160\n100 100\n60 20\n20 100\n\n1 1\n19 1\n19 60\n")
    check_refused(run("capture", "leaf.png", "--set", "outline.file=apart.txt"), 3, "apart.txt:7: what is traced from here on", "from line 1 on")


def test_svg_has_the_scans_colours():
    png("leaf.png", 120, 200, leaf_colour)
    run("capture", "leaf.png", *CAPTURE, "--maps", "none", "-o", "a")
    blade = re.search('id="blade" fill="#(..)(..)(..)"', open("a/leaf.svg").read())
    want = leaf_colour(60 + 20, 100)
    if any(abs(int(v, 16) - w) > 12 for v, w in zip(blade.groups(), want)):
        raise AssertionError((blade.group(0), want))
    run("capture", "leaf.png", *CAPTURE, "--maps", "none", "-o", "b", "--set", "texture.lamina_colour=#123456")
    same('fill="#123456"' in open("b/leaf.svg").read(), True)
    run("capture", "leaf.png", *CAPTURE, "--maps", "none", "-o", "c", "--set", "scan.texture=no")
    same('fill="#4f7a2c"' in open("c/leaf.svg").read(), True)


def test_withered_colours():
    write("small.ini", SMALL)
    colour = lambda *more: json.loads(run("shape", "small.ini", "--formats", "none", "--pose", "withered", "--json", *more).out)["parameters"]["texture"]
    fresh, old = colour("--set", "pose.age=0"), colour("--set", "pose.age=1", "--set", "texture.vein_colour=#010203")
    same((fresh["lamina_colour"], fresh["gloss"]), ("#4f7a2c", 0.5))
    red, green, blue = (int(old["lamina_colour"][i:i + 2], 16) for i in (1, 3, 5))
    if not red > green > blue or red > 110:
        raise AssertionError(old["lamina_colour"])
    same((old["vein_colour"], old["gloss"]), ("#010203", 0.1))


def test_capture_ways():
    png("leaf.png", 120, 200, leaf_colour)
    png("two.png", 220, 200, lambda x, y: leaf_colour(x, y) if x < 110 else leaf_colour(x, y, 165, 100, 35, 60))
    for more in (("--method", "fang"), ("--set", "scan.petiole=keep"), ("--set", "scan.base=60,180", "--set", "scan.tip=60,20"),
                 ("--set", "scan.veins=none"), ("--set", "scan.texture=no"), ("--back", "leaf.png")):
        done = run("capture", "leaf.png", *CAPTURE, "--maps", "base_color", "-o", "x", *more)
        if done.status:
            raise AssertionError((more, done.err))
    # an L-system's veins, in the picture as in what one goes on with
    done = run("capture", "leaf.png", *CAPTURE, "--maps", "none", "-o", "written", "--method", "fang", "--set", "veins.origin=lsystem", "--json")
    same((done.status, json.loads(done.out)["run"]["end"]), (0, "written by an L-system"))
    holds(open("written/leaf.ini", encoding="utf-8").read(), "origin = lsystem")
    again = run("grow", "written/leaf.ini", "--maps", "none", "-o", "again", "--json")
    veins = [json.loads(run_.out)["network"]["veins"] for run_ in (done, again)]
    same(abs(veins[0] - veins[1]) <= 5, True)  # the outline in hundredths of pixels cuts others
    done = run("capture", "two.png", *CAPTURE, "--maps", "none", "--each")
    same((done.status, "2 leaves captured" in done.err), (0, True))
    same([f"two_{i}.ini" in files("out/two") for i in (1, 2, 3)], [True, True, False])
    # drawn veins, from an SVG file and from lines of text
    write("veins.svg", '<svg xmlns="http://www.w3.org/2000/svg"><g id="veins"><path d="M60,178 L60,40" stroke-width="3"/>'
          '<path d="M60,120 L30,100"/></g></svg>')
    write("veins.txt", "60 178\n60 40\n\n60 120\n30 100\n")
    for drawing in ("veins.svg", "veins.txt"):
        done = run("capture", "leaf.png", *CAPTURE, "--maps", "none", "--drawing", drawing, "--set", "scan.base=60,180", "--set",
                   "scan.tip=60,20", "--json", "-o", drawing + ".d")
        same(done.status, 0)
        same((json.loads(done.out)["scan"]["veins"], json.loads(done.out)["scan"]["veins_from"]), (2, "drawing"))
    # grow and shape take the same, and do all at once
    for verb in ("grow", "shape"):
        done = run(verb, "leaf.png", *CAPTURE, "--set", "texture.maps=none", "--set", "veins.origin=drawn", "--drawing", "veins.svg", "--back", "leaf.png",
                   "--json", "-o", verb + ".d")
        same((done.status, json.loads(done.out)["scan"]["veins_from"]), (0, "drawing"))
        refused = run(verb, "leaf.png", *CAPTURE, "--back", "none.png")
        same((refused.status, "none.png" in refused.err), (3, True))
    refused = run("shape", "veins.graphml", "--drawing", "veins.svg")
    same((refused.status, "--drawing goes with a scan" in refused.err), (2, True))
    # a margin traced by hand, in pixels
    write("blade.txt", "60 180\n85 140\n90 90\n60 20\n30 90\n35 140\n")
    done = run("capture", "leaf.png", *CAPTURE, "--maps", "none", "--set", "outline.file=blade.txt", "--json", "-o", "traced")
    same(done.status, 0)
    same(json.loads(done.out)["scan"]["outline_from"], "drawing")
    write("eight.txt", "60 180\n90 90\n60 20\n100 170\n")
    refused = run("capture", "leaf.png", "--set", "outline.file=eight.txt")
    same((refused.status, "eight.txt:2: what is traced from here on" in refused.err), (3, True), refused.err)
    table = run("capture", "leaf.png", "--table")
    rows = [line.split() for line in table.out.splitlines()[3:]]
    same([row[0] for row in rows], ["1", "2", "4", "8", "16"])
    for row in rows: # fewer nodes with more tolerance, and with larger squares
        nodes = [int(n) for n in row[3:]]
        same(nodes, sorted(nodes, reverse=True))
    same([int(row[3]) for row in rows], sorted((int(row[3]) for row in rows), reverse=True))
    # Fang's operators side by side: about the same leaf, and curves close to its contour
    table = run("capture", "leaf.png", "--table", "--method", "fang")
    rows = [line.split() for line in table.out[table.out.index("operator  sigma"):].splitlines()[1:]]
    same([row[0] for row in rows], ["roberts", "sobel", "prewitt", "laplacian", "canny"])
    areas = [float(row[2]) for row in rows]
    same(max(areas) < 1.05 * min(areas), True)
    same([float(row[10]) < 1.0 for row in rows], [True] * 5) # mean deviation, pixels


def petiole_end(model):
    """How far the petiole of a flat blade, which points to -z, reaches, metres."""
    return max(float(line.split()[3]) for line in open(model, encoding="utf-8") if line.startswith("v "))


def test_shape_real_petiole():
    """The model's petiole is as long as that of the scan, at once or by way of a capture."""
    def stalked(length):
        return lambda x, y: (60, 110, 40) if abs(x - 60) < 3 and 175 < y <= 180 + length else leaf_colour(x, y)
    flat = "--formats", "obj", "--set", "pose.preset=flat", "--set", "mesh.petiole_bend=0"
    for length in 45, 75:
        png("stalked.png", 120, 270, stalked(length))
        done = run("shape", "stalked.png", *CAPTURE, *flat, "-o", "x")
        same(done.status, 0, done.err)
        same(run("capture", "stalked.png", *CAPTURE, "--maps", "none", "-o", "y").status, 0)
        same(run("shape", "y/stalked.ini", *flat, "-o", "z").status, 0)
        wanted = length / 161 * 0.1 # of a blade 161 pixels and 0.1 metres long
        found = petiole_end("x/stalked.obj"), petiole_end("z/stalked.obj")
        if abs(found[0] - wanted) > 0.1 * wanted or abs(found[1] - found[0]) > 0.03 * wanted:
            raise AssertionError(f"{found} m for {wanted} m")


def test_capture_refuses():
    png("leaf.png", 120, 200, leaf_colour)
    whole = open("leaf.png", "rb").read()
    for name, data, *parts in (("noise.png", b"no image at all", "is not a PNG, JPEG or TIFF image"), ("empty.png", b"", "is empty"),
                               ("cut.png", whole[:len(whole) // 2], "ends too early")):
        with open(name, "wb") as file:
            file.write(data)
        check_refused(run("capture", name), 3, name, *parts)
    check_refused(run("capture", "none.png"), 3, "none.png", "No such file")
    for name, size, colour in (("one.png", 1, 0), ("black.png", 50, 0), ("white.png", 50, 255)):
        png(name, size, size, lambda x, y, c=colour: (c, c, c))
        check_refused(run("capture", name), 3, name, "no leaf")
        check_refused(run("capture", name, "--table", "--method", "fang"), 3, name)
    check_refused(run("capture", "leaf.png", "--method", "magic"), 3, "--method magic", "contour or fang")
    check_refused(run("capture", "leaf.png", "--set", "scan.leaf=2"), 3, "leaf.png", "there is 1 in the image")
    write("nothing.svg", '<svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>')
    check_refused(run("capture", "leaf.png", "--drawing", "nothing.svg"), 3, "nothing.svg")
    write("outside.svg", '<svg xmlns="http://www.w3.org/2000/svg"><g id="veins"><path id="stray" d="M5,5 L100,5"/></g></svg>')
    check_refused(run("capture", "leaf.png", "--drawing", "outside.svg"), 3, "outside.svg", "stray")
    same(files("out") if os.path.isdir("out") else [], [])
    png("edge.png", 120, 200, lambda x, y: leaf_colour(x, y, 60, 100, 80, 80))
    done = run("capture", "edge.png", *CAPTURE, "--maps", "none")
    same((done.status, "touches the edge of the image" in done.err), (0, True))


def test_capture_memory():
    """Of 20 000 × 20 000 pixels less than three times the decoded image, or images, by what two smaller ones take. Besides there are only the images in which
    veins are looked for, which don't grow from the smaller one on."""
    if b"__asan_init" in open(VENATION, "rb").read():
        return # which keeps what is freed
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    def flat_leaf(size, channels): # an ellipse over half of the image
        packer = zlib.compressobj(1)
        def pixels(n, *rgb):
            return bytes(rgb if channels == 3 else rgb[1:2]) * n
        with open("flat.png", "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2 if channels == 3 else 0, 0, 0, 0)))
            for y in range(size):
                half = int(0.3 * size * max(0.0, 1 - ((y - size / 2) / (0.45 * size)) ** 2) ** 0.5)
                side = pixels(size // 2 - half, 250, 250, 248)
                file.write(chunk(b"IDAT", packer.compress(b"\0" + side + pixels(2 * half, 60, 110 + y % 3, 40) + side)))
            file.write(chunk(b"IDAT", packer.flush()) + chunk(b"IEND", b""))
    def peak(*args): # the memory of a child counts from that of its parent on, so there is a small one between
        between = "import os, sys; _, s, u = os.wait4(os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ), 0); print(u.ru_maxrss); sys.exit(s != 0)"
        return 1024 * int(subprocess.run([sys.executable, "-ISc", between, VENATION, *args], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout)
    plain = ("--set", "scan.veins=none")
    ways = (plain, (), ("--method", "fang", *plain), ("--each", *plain), ("--each", "--back", "flat.png", *plain))
    for channels in (1, 3):
        used, sizes = [], (1400, 2600)
        for size in sizes:
            flat_leaf(size, channels)
            used.append([peak("capture", "flat.png", *CAPTURE, "--maps", "none", "--quiet", "-o", "flat", *how) for how in ways])
        for how, small, large in zip(ways, *used):
            decoded = [channels * n * n * (2 if "--back" in how else 1) for n in (*sizes, 20000)]
            most = large + (large - small) / (decoded[1] - decoded[0]) * (decoded[2] - decoded[1])
            if not most < 3 * decoded[2]:
                raise AssertionError(f"{channels} channels, {how}: {small} and {large} bytes for images of {decoded[0]} and {decoded[1]}")


def test_endless_file():
    write("small.ini", SMALL)
    check_refused(run("grow", "small.ini", "--set", "outline.file=/dev/zero"), 3, "/dev/zero")
    check_refused(run("grow", "small.ini", "--set", "sources.placement=list", "--set", "sources.file=/dev/zero"), 3, "/dev/zero")


def test_grow_conflicts():
    """Values that are allowed one by one, but not together."""
    write("small.ini", SMALL)
    def refused(said, *sets):
        check_refused(run("grow", "small.ini", *(word for s in sets for word in ("--set", s))), 3, said)
    uneven = "growth.kind=nonuniform", "growth.steps=40"
    refused("rate_y: at height y", *uneven, "growth.rate_y=0,2;1,2")
    refused("more than 10000 times as narrow", *uneven, "growth.rate_x=0,-0.9;1,0")
    refused("would make a leaf of 1.47e+06 segments", *uneven, "growth.rate_y=0,0.2;1,0.2", "growth.initial_length=1000")
    refused("darts a step on a blade of", "sources.density=100", "growth.final_length=9000")
    refused("darts in the 4980000 steps", "sources.density=3", "growth.final_length=5000", "growth.step=0.001")
    refused("throws a dart where there is room for one", "sources.density=1e-7", "growth.final_length=3000", "veins.kill_distance=1",
            "sources.birth_distance_veins=1")
    refused("needs growth.kind = marginal or none", "sources.placement=margin")
    refused("venation: --set veins.drawing: a text file of lines is in pixels of a scan", "veins.origin=drawn", "veins.drawing=lines.txt")
    refused("[lsystem]: ", "veins.origin=lsystem", "lsystem.productions=F=F[")


def test_shape_of_bare_network():
    """A network without a margin lies in the outline of the parameters."""
    node = '<node id="{}"><data key="x">0</data><data key="y">{}</data></node>'
    write("bare.graphml", '<graphml><key id="x" for="node" attr.name="x" attr.type="double"/><key id="y" for="node" attr.name="y" attr.type="double"/>'
          '<graph edgedefault="directed">' + node.format("a", 0) + node.format("b", 9) + '<edge source="a" target="b"/></graph></graphml>')
    blade = "outline.path=M0,0 C20,10 10,40 0,50 C-10,40 -20,10 0,0 Z"
    check_refused(run("shape", "bare.graphml"), 3, "no attribute 'margin'")
    check_refused(run("shape", "bare.graphml", "--set", "outline.file=no.svg"), 3, "no.svg")
    check_refused(run("shape", "bare.graphml", "--set", blade, "--set", "growth.final_length=5"), 3, "the node at 0,9 lies 4 segments outside the margin")
    result = run("shape", "bare.graphml", "--set", blade, "--set", "growth.final_length=20", "--size", "16", "--formats", "obj")
    same(result.status, 0, result.err)
    places = [[float(x) for x in line.split()[1:]] for line in open("out/bare/bare.obj", encoding="utf-8") if line.startswith("v ")]
    width = max(p[0] for p in places) - min(p[0] for p in places)
    if abs(width - 0.046) > 0.0005: # of a leaf 0.1 m long; the curves are 0.46 times as wide
        raise AssertionError(f"{width} m wide")


def test_shape_refuses():
    write("small.ini", SMALL)
    check_refused(run("shape"), 2, "a file is missing")
    check_refused(run("shape", "small.ini", "--pose", "wiltered"), 3, "venation: --pose wiltered: must be one of", "withered")
    check_refused(run("shape", "small.ini", "--formats", "glbb"), 3, "did you mean 'glb'?")
    check_refused(run("shape", "small.ini", "--params", "small.ini"), 2, "--params")
    check_refused(run("shape", "small.ini", "--set", "pose.rules=no_such_vein lift 10"), 3, "no_such_vein")
    check_refused(run("shape", "small.ini", "--set", "pose.rules=midrib lift much"), 3, "much")
    check_refused(run("shape", "small.ini", "--set", "pose.keyframes=2 blend=0; 1 blend=1"), 3, "keyframes")
    check_refused(run("shape", "small.ini", "--set", "pose.keyframes=0 blnd=0"), 3, "blend")
    check_refused(run("shape", "small.ini", "--set", "mesh.fictitious_veins=0,0"), 3, "two points")
    check_refused(run("shape", "small.ini", "--set", "mesh.min_angle=60"), 3, "33")
    check_refused(run("shape", "small.ini", "--size", "16384"), 3, "at most 12 are allowed, enough for")
    write("empty.graphml", "")
    check_refused(run("shape", "empty.graphml"), 3, "empty.graphml")
    write("bare.graphml", '<graphml><key id="x" for="node" attr.name="x" attr.type="double"/><key id="y" for="node" attr.name="y" '
          'attr.type="double"/><graph edgedefault="directed"><node id="a"><data key="x">0</data><data key="y">0</data></node>'
          '<node id="b"><data key="x">0</data><data key="y">9</data></node><edge source="a" target="b"/></graph></graphml>')
    check_refused(run("shape", "bare.graphml"), 3, "margin")
    same(files("out") if os.path.isdir("out") else [], [])


def test_completion():
    need("bash")
    write("completion", run("params", "--format=bash").out)
    done = subprocess.run(["bash", "-n", "completion"], stderr=subprocess.PIPE, check=False)
    same((done.returncode, done.stderr), (0, b""))
    write("leaf.ini", SMALL)
    write("leaf.txt", "")
    write("leaf.graphml", "")
    write("outline.svg", "")
    write("scan.png", "")
    write("scan.jpg", "")
    os.mkdir("leaves")
    cases = {
        "venation ": ["grow", "shape", "capture", "sweep", "params", "help", "--version", "--help"],
        "venation gr": ["grow"],
        "venation help p": ["params"],
        "venation shape le": ["leaves", "leaf.graphml", "leaf.ini"],
        "venation shape leaf.graphml --params le": ["leaves", "leaf.ini"],
        "venation shape leaf.ini --pose wi": ["withered"],
        "venation shape leaf.ini --formats glb,p": ["glb,ply", "glb,pov"],
        "venation grow le": ["leaves", "leaf.ini"],
        "venation grow sc": ["scan.jpg", "scan.png"],
        "venation sweep le": ["leaves", "leaf.ini"],
        "venation sweep leaf.ini --picture ": ["veins", "specimen"],
        "venation shape sc": ["scan.jpg", "scan.png"],
        "venation capture sc": ["scan.jpg", "scan.png"],
        "venation capture scan.jpg --back sc": ["scan.jpg", "scan.png"],
        "venation capture scan.jpg --drawing out": ["outline.svg"],
        "venation grow leaf.ini --se": ["--seed", "--set"],
        "venation grow leaf.ini --set veins.k": ["veins.kill_distance="],
        "venation grow leaf.ini --set veins.pattern=": ["open", "closed"],
        "venation grow leaf.ini --set veins.pattern=cl": ["closed"],
        "venation grow leaf.ini --set=veins.pattern=cl": ["closed"],
        "venation grow leaf.ini --set outline.mirror=": ["yes", "no"],
        "venation grow leaf.ini --set outline.file=outl": ["outline.svg"],
        "venation grow leaf.ini --set texture.maps=he": ["height"],
        "venation grow leaf.ini --maps he": ["height"],
        "venation grow leaf.ini --maps opacity,he": ["opacity,height"],
        "venation grow leaf.ini --frames ": ["svg", "maps"],
        "venation grow leaf.ini -o lea": ["leaves"],
        "venation grow leaf.ini --seed ": [],
        "venation params --format=ma": ["markdown", "man"],
        "venation params --format=z": ["zsh"],
        "venation params veins.pat": ["veins.pattern"],
        "venation params vei": ["veins"] + [key for key in keys() if key.startswith("vei")],
    }
    for line, wanted in cases.items():
        same(sorted(completions(line)), sorted(wanted), f"completing {line!r}")
    options = completions("venation grow leaf.ini --")
    for option in re.findall(r"(?<= )--[a-z]+(?=[ =])", run("help", "grow").out.split("Files:")[0]):
        if option not in options:
            raise AssertionError(f"no {option} among {options}")


def test_completion_zsh():
    text = run("params", "--format=zsh").out
    if not text.startswith("#compdef venation\n"):
        raise AssertionError(text[:80])
    for key in keys():
        holds(text, f"\n    '{key}:")
    for option in re.findall(r"(?<= )--[a-z]+(?=[ =])", run("help", "grow").out.split("Files:")[0]):
        holds(text, option)
    need("zsh")
    done = subprocess.run(["zsh", "-fn", write("_venation", text)], stderr=subprocess.PIPE, check=False)
    same((done.returncode, done.stderr), (0, b""))
    program = ("compdef() { :; }; source ./_venation; print -l $_venation_maps; IPREFIX=--set=veins.pattern=; compset() { :; }; "
               "compadd() { print -- $@; }; _venation_set")  # with the completion's own commands played
    done = subprocess.run(["zsh", "-fc", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    same(done.stderr, b"")
    shown = done.stdout.decode().split()
    same((shown[:3], shown[-3:]), (["all", "none", "base_color"], ["--", "open", "closed"]))


def test_completion_fish():
    text = run("params", "--format=fish").out
    for key in keys():
        holds(text, f"\n    {key}=\\t'")
    need("fish")
    write("venation.fish", text)
    done = subprocess.run(["fish", "--no-config", "-n", "venation.fish"], stderr=subprocess.PIPE, check=False)
    same((done.returncode, done.stderr), (0, b""))
    write("leaf.ini", SMALL)
    write("outline.svg", "")
    write("scan.png", "")
    write("scan.jpg", "")
    os.mkdir("leaves")
    cases = {
        "venation ": ["grow", "shape", "capture", "sweep", "params", "help"],
        "venation gr": ["grow"],
        "venation help p": ["params"],
        "venation shape leaf.ini --formats glb,p": ["glb,ply", "glb,pov"],
        "venation grow le": ["leaves/", "leaf.ini"],
        "venation grow leaf.ini --se": ["--seed", "--set"],
        "venation grow leaf.ini --set veins.k": ["veins.kill_distance="],
        "venation grow leaf.ini --set veins.pattern=": ["veins.pattern=open", "veins.pattern=closed"],
        "venation grow leaf.ini --set=veins.pattern=cl": ["--set=veins.pattern=closed"],
        "venation grow leaf.ini --set outline.file=outl": ["outline.file=outline.svg"],
        "venation grow leaf.ini --maps opacity,he": ["opacity,height"],
        "venation grow leaf.ini --frames ": ["svg", "maps"],
        "venation grow leaf.ini -o lea": ["leaves/"],
        "venation grow leaf.ini --seed ": [],
        "venation params veins.pat": ["veins.pattern"],
        "venation params vei": ["veins"] + [key for key in keys() if key.startswith("vei")],
    }
    for line, wanted in cases.items():
        program = f"source ./venation.fish; complete -C '{line}'"
        done = subprocess.run(["fish", "--no-config", "-c", program], env=environment(HOME=os.getcwd()), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, check=False)
        same(done.stderr, b"", f"stderr of completing {line!r}")
        same(sorted(shown.split("\t")[0] for shown in done.stdout.decode().splitlines()), sorted(wanted), f"completing {line!r}")


# --- the script that installs, builds and runs -------------------------------------------------------------------

def test_run_tells():
    """`run` with everything it calls played by scripts: what it says when it has long work to do."""
    os.makedirs("bin")
    for name, text in (("dpkg-query", "[ -f missing ] || echo 'install ok installed'"), ("id", "echo 0"), ("apt-get", ": >apt"),
                       ("meson", 'mkdir -p "$2/src"; : >"$2/build.ninja"'),
                       ("ninja", 'case "$*" in *" -n "*) if [ -f changed ]; then echo "[1/1] x"; else echo "ninja: no work to do."; fi ;;\n'
                                 '*) [ ! -f broken ] || { echo "a wrong line"; exit 1; }\n'
                                 'printf \'#!/bin/sh\\necho "leaf $*"\\n\' >"$2/src/venation"; chmod +x "$2/src/venation" ;; esac')):
        write(f"bin/{name}", f"#!/bin/sh\n{text}\n")
        os.chmod(f"bin/{name}", 0o755)
    script = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "run")

    def call(*present):
        for name in ("missing", "changed", "broken"):
            if os.path.exists(name):
                os.remove(name)
        for name in present:
            write(name, "")
        env = environment(PATH=f"{os.getcwd()}/bin:{os.environ['PATH']}", VENATION_BUILD=f"{os.getcwd()}/build")
        done = subprocess.run(["sh", script, "grow", "x"], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=TIMEOUT, check=False)
        return Result(done.returncode, done.stdout.decode(), done.stderr.decode())

    first = call("missing")
    same((first.status, first.out), (0, "leaf grow x\n"), first.err)
    holds(first.err, "run: installing gcc")
    holds(first.err, "run: building (the first time takes about a minute)\n")
    again = call()
    same((again.status, again.out, again.err), (0, "leaf grow x\n", ""))
    same(call("changed").err, "run: building what has changed\n")
    broken = call("changed", "broken")
    same((broken.status, broken.out, broken.err), (1, "", "run: building what has changed\na wrong line\nrun: the build failed\n"))


# -----------------------------------------------------------------------------------------------------------------

if __name__ == "__main__":
    sys.exit(main(globals()))
