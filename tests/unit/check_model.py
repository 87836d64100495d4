#!/usr/bin/python3
"""Has other people's programs read and render exported leaves.

    check_model.py DIR NAME:VERTICES:TRIANGLES…

For each NAME the folder holds NAME.obj, NAME.ply, NAME.inc, NAME.pov and NAME.glb. The maps are red on the leaf's left half and
blue on its right; on the shadow side yellow and cyan. Programs that are not installed are skipped: assimp, povray, the
Khronos validator (node with the package gltf-validator, found by NODE_PATH), blender. Prints what ran and what was skipped.
Exits with 77 when nothing ran.
"""
import json
import os
import re
import shutil
import subprocess
import sys

HUES = {  # from each channel whether it is strong
    "red": (True, False, False), "blue": (False, False, True), "yellow": (True, True, False), "cyan": (False, True, True),
}


def run(*command, cwd=None):
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, errors="replace", timeout=500)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
    return done.stdout + done.stderr


def centres(width, height, pixel):
    """Mean place (0 … 1, y down) and share of the pixels of each hue; a pixel counts when its strong channels are far above the weak."""
    found = {}
    for name, strong in HUES.items():
        n = sx = sy = 0
        for y in range(height):
            for x in range(width):
                rgb = pixel(x, y)
                on = [c for c, s in zip(rgb, strong) if s]
                off = [c for c, s in zip(rgb, strong) if not s]
                if min(on) > 60 and min(on) > 1.6 * max(off):
                    n, sx, sy = n + 1, sx + x, sy + y
        if n > 0:
            found[name] = (sx / n / width, sy / n / height, n / width / height)
    return found


def read_ppm(path):
    data = open(path, "rb").read()
    head = re.match(rb"P6\s+(?:#.*\s+)*(\d+)\s+(\d+)\s+255\s", data)
    width, height = int(head[1]), int(head[2])
    body = data[head.end():]
    return width, height, lambda x, y: body[3 * (y * width + x):3 * (y * width + x) + 3]


def read_bmp(path):
    data = open(path, "rb").read()
    at, width, height = (int.from_bytes(data[k:k + 4], "little") for k in (10, 18, 22))
    bits = int.from_bytes(data[28:30], "little") // 8
    row = (width * bits + 3) // 4 * 4

    def pixel(x, y):
        k = at + (height - 1 - y) * row + x * bits
        return data[k + 2], data[k + 1], data[k]
    return width, height, pixel


def expect_sides(what, seen, left, right, least=0.02):
    """Both colours are to be seen, in their order across the picture."""
    for name in (left, right):
        if seen.get(name, (0, 0, 0))[2] < least:
            sys.exit(f"{what}: {name} is hardly to be seen: {seen}")
    if seen[left][0] > seen[right][0]:
        sys.exit(f"{what}: mirrored, {left} should be left of {right}: {seen}")


def check_assimp(folder, name, vertices, triangles):
    for kind in ("obj", "ply", "glb"):
        path = os.path.join(folder, f"{name}.{kind}")
        text = run("assimp", "info", path, "-r")
        found = [int(re.search(rf"^{key}:\s+(\d+)", text, re.M)[1]) for key in ("Vertices", "Faces")]
        # its OBJ reader makes vertices of corners
        want = [3 * triangles if kind == "obj" else vertices, triangles]
        if found != want:
            sys.exit(f"assimp finds {found} vertices and faces in {path}, not {want}")


FACING = """#version 3.7;
global_settings {{ assumed_gamma 1.0 }}
{option}
#include "{name}.inc"
camera {{ orthographic location <1, 8, {z}> look_at <1, 8, 0> right 20 * x up 20 * y }}
light_source {{ <1, 8, {z}> rgb 1 parallel point_at <1, 8, 0> }}
background {{ rgb 1 }}
object {{ leaf_with_veins }}
"""


def check_povray(folder, name, vertices, triangles):
    def render(scene):
        run("povray", scene, "+W120", "+H120", "+FP", "-D", "+Ocheck.ppm", "-GA", cwd=folder)
        return centres(*read_ppm(os.path.join(folder, "check.ppm")))

    seen = render(f"{name}.pov")
    if not has_maps(folder, name):
        return
    expect_sides(f"{name}.pov", seen, "red", "blue")
    # face to face with either side, which turns left and right
    for z, left, right in ((-50, "red", "blue"), (50, "cyan", "yellow")):
        with open(os.path.join(folder, "side.pov"), "w") as f:
            f.write(FACING.format(name=name, z=z, option="" if z < 0 else "#declare round_veins = 1;"))
        expect_sides(f"{name}.inc seen from z = {z}", render("side.pov"), left, right)
    os.unlink(os.path.join(folder, "side.pov"))
    os.unlink(os.path.join(folder, "check.ppm"))


def has_maps(folder, name):
    return "png" in open(os.path.join(folder, f"{name}.inc")).read()


VALIDATE = """
const fs = require('fs'), validator = require('gltf-validator');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])), {maxIssues: 100})
    .then(report => console.log(JSON.stringify(report)), e => { console.error(e); process.exit(1); });
"""


def check_validator(folder, name, vertices, triangles):
    path = os.path.join(folder, f"{name}.glb")
    report = json.loads(run("node", "-e", VALIDATE, path))
    issues = report["issues"]
    # what it does not know is no fault: the extension, and the texture that only the extension uses
    harmless = ("UNSUPPORTED_EXTENSION", "UNUSED_OBJECT")
    bad = [m for m in issues["messages"] if m["code"] not in harmless]
    if issues["numErrors"] or issues["numWarnings"] or bad:
        sys.exit(f"{path}: {json.dumps(bad, indent=1)}")
    found = report["info"]["totalVertexCount"], report["info"]["totalTriangleCount"]
    if found != (vertices, triangles):
        sys.exit(f"gltf-validator counts {found} in {path}, not {(vertices, triangles)}")


BLENDER = """
import bpy, math, numpy, sys
if not hasattr(numpy, 'bool'):  # Blender 3.4's importer asks NumPy 1.24, as in Debian 12, for a name that is gone
    numpy.bool = bool
path, out = sys.argv[-2:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=path)
meshes = [o for o in bpy.data.objects if o.type == 'MESH' and o.name.split('_')[-1] in ('blade', 'veins')]
print('COUNT', sum(len(o.data.vertices) for o in meshes), sum(len(o.data.polygons) for o in meshes))
print('BONES', sum(len(a.bones) for a in bpy.data.armatures))
print('KEYS', max([len(k.key_blocks) for k in bpy.data.shape_keys], default=0))
low = [min(v.co[k] for o in meshes for v in o.data.vertices) for k in range(3)]
high = [max(v.co[k] for o in meshes for v in o.data.vertices) for k in range(3)]
print('BOX', *low, *high)
scene = bpy.context.scene
scene.render.engine = 'CYCLES'
scene.cycles.samples = 8
scene.cycles.use_denoising = False
scene.render.resolution_x = scene.render.resolution_y = 120
scene.render.image_settings.file_format = 'BMP'
scene.view_settings.view_transform = 'Standard'
scene.world = bpy.data.worlds.new('sky')
scene.world.use_nodes = True
scene.world.node_tree.nodes['Background'].inputs[0].default_value = (1, 1, 1, 1)
camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
camera.data.type = 'ORTHO'
camera.data.ortho_scale = 1.1 * max(high[0] - low[0], high[1] - low[1])
camera.data.clip_start = 0.001
scene.collection.objects.link(camera)
scene.camera = camera
for side, turn in ((1, 0), (-1, math.pi)):
    camera.location = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, side * 0.5]
    camera.rotation_euler = (0, turn, 0)
    scene.render.filepath = out + ('above' if side > 0 else 'below') + '.bmp'
    bpy.ops.render.render(write_still=True)
"""


def check_blender(folder, name, vertices, triangles):
    path, out = os.path.join(folder, f"{name}.glb"), os.path.join(folder, "blender_")
    text = run("blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", BLENDER, "--", path, out)
    facts = {line.split()[0]: [float(w) for w in line.split()[1:]] for line in text.splitlines()
             if re.match("(COUNT|BONES|KEYS|BOX) ", line)}
    if facts["COUNT"] != [vertices, triangles]:
        sys.exit(f"Blender finds {facts['COUNT']} vertices and triangles in {path}, not {[vertices, triangles]}")
    with open(path, "rb") as f:
        data = f.read()
    gltf = json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])
    bones = len(gltf["skins"][0]["joints"]) if "skins" in gltf else 0
    targets = len(gltf["meshes"][0]["primitives"][0].get("targets", []))
    if facts["BONES"] != [bones] or facts["KEYS"] != [targets + 1 if targets else 0]:
        sys.exit(f"Blender finds bones {facts['BONES']} and shape keys {facts['KEYS']} in {path}, not {bones} and {targets}")
    low, high = facts["BOX"][:3], facts["BOX"][3:]
    if not (high[1] > 0.07 and high[0] > -low[0] > 0):  # the tip along y, the broad side at the right
        sys.exit(f"Blender: the leaf lies wrongly in {path}: {low} … {high}")
    if has_maps(folder, name):
        for side, left, right in (("above", "red", "blue"), ("below", "blue", "red")):
            expect_sides(f"Blender, {side}, {path}", centres(*read_bmp(f"{out}{side}.bmp")), left, right)
    if not os.environ.get("VENATION_KEEP_MODELS"):
        for side in ("above", "below"):
            os.unlink(f"{out}{side}.bmp")


def have_validator():
    return shutil.which("node") and subprocess.run(["node", "-e", "require('gltf-validator')"], capture_output=True).returncode == 0


def main(folder, *leaves):
    checks = (("assimp", shutil.which("assimp"), check_assimp), ("povray", shutil.which("povray"), check_povray),
              ("gltf-validator", have_validator(), check_validator), ("blender", shutil.which("blender"), check_blender))
    ran = 0
    for program, there, check in checks:
        if not there:
            if program in ("assimp", "povray") and os.environ.get("VENATION_REQUIRE") == "all":
                sys.exit(f"{program} is not installed")
            print(f"{program}: skipped, not installed")
            continue
        for leaf in leaves:
            name, vertices, triangles = leaf.split(":")
            check(folder, name, int(vertices), int(triangles))
        print(f"{program}: read {len(leaves)} leaves")
        ran += 1
    sys.exit(0 if ran else 77)


if __name__ == "__main__":
    main(*sys.argv[1:])
