#!/usr/bin/env python3
"""A mirror bean of 100 352 triangles, 1280x720, here and in Blender's Cycles: time at equal noise.

    cycles.py --program build/release/apps/chromeball/chromeball [--keep DIR] [--reference N] MAP.exr

MAP is a lat-long. Both get the same mesh with the same normals, the same camera, the map behind, a box filter of a
pixel, and let the bean see itself. Noise is the RMS of x / (1 + x) against the same program's picture of --reference
samples a pixel; how far those two pictures are from each other says that they are of the same thing.

Times are of the processor (user and system, all threads), which other work on the machine changes little. Ours
are those of the whole command, with starting, reading and writing; Cycles' those of rendering alone, with mesh, tree
and map loaded by a picture before (persistent data).

Needs blender, python3-openimageio and python3-numpy.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import tempfile
import time

import numpy as np

WIDTH, HEIGHT, FOV = 1280, 720, 35
AZIMUTH, ELEVATION, DISTANCE = 30, 15, 4
OURS = (1, 4, 9, 16)
THEIRS = (1, 2, 4, 8, 16, 32, 64)

IN_BLENDER = """
import bpy, json, os, sys, time
import numpy as np
o = json.load(open(sys.argv[-1]))
data = np.load(o["mesh"])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
c = scene.cycles
c.device, c.use_adaptive_sampling, c.use_denoising = "CPU", False, False
c.pixel_filter_type = "BOX"
c.max_bounces = c.glossy_bounces = 16
c.sample_clamp_indirect = c.blur_glossy = c.light_sampling_threshold = 0
c.use_auto_tile = False
scene.render.use_persistent_data = True
scene.render.threads_mode, scene.render.threads = "FIXED", o["threads"]
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *o["size"], 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"

# (x, y, z) of a Y-up world whose maps have +Z in the middle is (z, x, y) here.
turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)
mesh = bpy.data.meshes.new("bean")
mesh.from_pydata((data["positions"] @ turn.T).tolist(), [], data["triangles"].tolist())
mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
mesh.use_auto_smooth = True
mesh.normals_split_custom_set_from_vertices((data["normals"] @ turn.T).tolist())
bean = bpy.data.objects.new("bean", mesh)
scene.collection.objects.link(bean)
mirror = bpy.data.materials.new("mirror")
mirror.use_nodes = True
nodes = mirror.node_tree.nodes
nodes.clear()
glossy, out = nodes.new("ShaderNodeBsdfGlossy"), nodes.new("ShaderNodeOutputMaterial")
glossy.distribution = "SHARP"
glossy.inputs["Color"].default_value = (1, 1, 1, 1)
mirror.node_tree.links.new(glossy.outputs[0], out.inputs[0])
mesh.materials.append(mirror)

world = bpy.data.worlds.new("world")
world.use_nodes = True
nodes = world.node_tree.nodes
nodes.clear()
sky, light, out = (nodes.new(n) for n in ("ShaderNodeTexEnvironment", "ShaderNodeBackground", "ShaderNodeOutputWorld"))
sky.image = bpy.data.images.load(o["map"])
sky.image.colorspace_settings.name = "Linear"
world.node_tree.links.new(sky.outputs[0], light.inputs[0])
world.node_tree.links.new(light.outputs[0], out.inputs[0])
world.cycles.sampling_method = "NONE"
scene.world = world

camera = bpy.data.cameras.new("camera")
camera.sensor_fit, camera.angle = "VERTICAL", np.radians(o["fov"])
eye = bpy.data.objects.new("eye", camera)
matrix = np.eye(4)
matrix[:3, :3] = turn @ np.array(o["axes"]).T
matrix[:3, 3] = turn @ np.array(o["eye"])
eye.matrix_world = matrix.T.tolist()
scene.collection.objects.link(eye)
scene.camera = eye

results = []
for i, samples in enumerate([1] + o["samples"]):
    c.samples, c.seed = samples, i
    scene.render.filepath = o["folder"] + "/cycles%d.exr" % samples
    before, start = os.times(), time.time()
    bpy.ops.render.render()
    after = os.times()
    results.append([samples, after.user - before.user + after.system - before.system, time.time() - start])
    bpy.data.images["Render Result"].save_render(scene.render.filepath)
json.dump(results[1:], open(o["folder"] + "/cycles.json", "w"))
"""


def bean():
    """As chromeball's own: positions, normals, triangles."""
    around, up = 256, 197

    def surface(u, v):
        a, e = 2 * math.pi * u, math.pi * (v - 0.5)
        x, y, z = np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)
        p = np.stack([x, 0.5 * y, 0.62 * z], -1)
        below = 0.5 * (1 - y)
        along = np.exp(-p[..., 0] ** 2 / 0.16)
        p[..., 1] += below**2 * (0.34 * along + 0.16 * along * np.exp(-p[..., 2] ** 2 / 0.08)) - 0.12 * p[..., 0] ** 2
        return p

    u, v = np.meshgrid(np.arange(around) / around, np.arange(up + 1) / up)
    # At the poles a little further in, where the surface has two directions.
    w, h = np.clip(v, 1e-3, 1 - 1e-3), 1e-4
    normals = np.cross(surface(u + h, w) - surface(u - h, w), surface(u, w + h) - surface(u, w - h)).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    positions = surface(u, v).reshape(-1, 3)
    positions -= (positions.min(0) + positions.max(0)) / 2
    positions /= np.linalg.norm(positions, axis=1).max()
    j, i = np.mgrid[0:up, 0:around]
    at = lambda i, j: j * around + i % around
    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    lower, upper = np.stack([a, b, c], -1)[1:], np.stack([a, c, d], -1)[:-1]  # not those that are lines at the poles
    return positions, normals, np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)])


def write_ply(path, positions, normals, triangles):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(positions)}"]
    header += [f"property float {p}" for p in ("x", "y", "z", "nx", "ny", "nz")]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header\n"]
    faces = np.zeros(len(triangles), [("n", "u1"), ("at", "<i4", 3)])
    faces["n"], faces["at"] = 3, triangles
    path.write_bytes("\n".join(header).encode() + np.hstack([positions, normals]).astype("<f4").tobytes() + faces.tobytes())


def floats(path):
    import OpenImageIO as oiio

    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]


def compressed(path):
    x = np.maximum(floats(path), 0)
    return x / (1 + x)


def ours(program, sky, mesh, samples, path):
    words = [program, "preview", sky, "--from", "latlong", "--input-space", "scene_linear", "--mesh", mesh, "--shading",
             "raytrace", "--background", "--orbit", f"{AZIMUTH},{ELEVATION},{DISTANCE}", "--fov", FOV,
             "--size", f"{WIDTH},{HEIGHT}", "--samples", samples, "--float", "-o", path, "--quiet"]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.time()
    subprocess.run([str(w) for w in words], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, time.time() - start


def theirs(folder, sky, samples):
    az, el = math.radians(AZIMUTH), math.radians(ELEVATION)
    back = np.array([math.cos(el) * math.sin(az), math.sin(el), math.cos(el) * math.cos(az)])
    right = np.array([math.cos(az), 0, -math.sin(az)])
    (folder / "job.json").write_text(json.dumps({
        "mesh": str(folder / "mesh.npz"), "map": str(sky), "folder": str(folder), "size": [WIDTH, HEIGHT], "fov": FOV,
        "axes": [right.tolist(), np.cross(back, right).tolist(), back.tolist()], "eye": (DISTANCE * back).tolist(),
        "samples": list(samples), "threads": os.cpu_count()}))
    (folder / "in_blender.py").write_text(IN_BLENDER)
    done = subprocess.run(["blender", "-b", "--factory-startup", "-noaudio", "-P", str(folder / "in_blender.py"), "--",
                           str(folder / "job.json")], capture_output=True, text=True)
    if not (folder / "cycles.json").exists():
        raise SystemExit(done.stdout[-1500:] + done.stderr[-1500:])
    return {n: (cpu, wall) for n, cpu, wall in json.loads((folder / "cycles.json").read_text())}


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--program", type=pathlib.Path, required=True)
    arguments.add_argument("--keep", type=pathlib.Path)
    arguments.add_argument("--reference", type=int, default=256)
    arguments.add_argument("map", type=pathlib.Path)
    o = arguments.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = o.keep.resolve() if o.keep else pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        positions, normals, triangles = bean()
        write_ply(folder / "bean.ply", positions, normals, triangles)
        np.savez(folder / "mesh.npz", positions=positions, normals=normals, triangles=triangles)
        program, sky = o.program.resolve(), o.map.resolve()
        ours(program, sky, folder / "bean.ply", o.reference, folder / f"ours{o.reference}.exr")
        reference = compressed(folder / f"ours{o.reference}.exr")
        times = theirs(folder, sky, (*THEIRS, o.reference))
        their_reference = compressed(folder / f"cycles{o.reference}.exr")
        off = math.sqrt(np.mean((reference - their_reference) ** 2))
        print(f"{len(triangles)} triangles; pictures of {o.reference} samples: RMS {off:.5f} apart")
        noise = {}
        for n in THEIRS:
            noise[n] = math.sqrt(np.mean((compressed(folder / f"cycles{n}.exr") - their_reference) ** 2))
            print(f"Cycles     {n:3} samples: noise {noise[n]:.5f}, {times[n][0]:7.3f} s, {times[n][1]:7.3f} s by the clock")
        for n in OURS:
            path = folder / f"ours{n}.exr"
            runs = [ours(program, sky, folder / "bean.ply", n, path) for _ in range(3)]
            cpu, wall = (min(r[k] for r in runs) for k in (0, 1))
            mine = math.sqrt(np.mean((compressed(path) - reference) ** 2))
            # Between the sample counts tried, noise and time are taken as powers of the count.
            logs = [np.log([noise[k] for k in THEIRS]), np.log([times[k][0] for k in THEIRS]), np.log(THEIRS)]
            order = np.argsort(logs[0])
            same, count = (math.exp(np.interp(math.log(mine), logs[0][order], l[order])) for l in (logs[1], logs[2]))
            within = min(noise.values()) <= mine <= max(noise.values())
            print(f"chromeball {n:3} samples: noise {mine:.5f}, {cpu:7.3f} s, {wall:7.3f} s by the clock; Cycles has that "
                  f"noise {'' if within else 'beyond what was tried, '}at {count:.1f} samples after {same:.2f} s: {same / cpu:.1f} times as long")


main()
