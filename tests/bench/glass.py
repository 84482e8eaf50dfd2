#!/usr/bin/env python3
"""A glass ball in the light of maps, here and in POV-Ray, on the same pixels.

    glass.py --program build/release/apps/chromeball/chromeball [--keep DIR] MAP.exr...

Each MAP is a lat-long in the scene's own colours. Prints the PSNR on x / (1 + x) inside the ball of our picture
against POV-Ray's, and of a ball of another index (1.45 instead of 1.5) to show that the measure tells. --keep
leaves pictures: POV-Ray's, ours, and four times their difference.

POV-Ray applies Fresnel's equations inside of the glass, too, but only while the ball is the one thing that the ray is
inside of: a sky made of a `hollow` sphere around everything is another, and then it takes the ratio of indices at
the far side as 1. So the sky is a `sky_sphere`.

Needs povray, openimageio-tools, python3-openimageio and python3-numpy.
"""
import argparse
import math
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT, FOV, SAMPLES = 480, 360, 35, 8
AZIMUTH, ELEVATION, DISTANCE = 30, 15, 4
INDEX, OTHER_INDEX = 1.5, 1.45

SCENE = """#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 24 adc_bailout 0 }}
// Right-handed, as glTF and OpenGL: the picture's right is turned over.
camera {{ perspective location <{x}, {y}, {z}> right <{aspect}, 0, 0> up y angle {angle} look_at <0, 0, 0> }}
sky_sphere {{ pigment {{ image_map {{ exr "{sky}" gamma 1 map_type 1 interpolate 2 }} rotate <0, 90, 0> }} }}
sphere {{ 0, 1
  pigment {{ rgbt 1 }}
  finish {{ ambient 0 diffuse 0 specular 0 reflection {{ 0, 1 fresnel on }} conserve_energy }}
  interior {{ ior {index} }}
}}
"""


def run(words, **more):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **more)
    if done.returncode:
        raise SystemExit(f"{words[0]}: {done.stderr[-800:]}")


def floats(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]


def by_povray(sky, folder):
    around, up = math.radians(AZIMUTH), math.radians(ELEVATION)
    slope = math.tan(math.radians(FOV / 2))
    (folder / "glass.pov").write_text(SCENE.format(
        x=DISTANCE * math.cos(up) * math.sin(around), y=DISTANCE * math.sin(up),
        z=DISTANCE * math.cos(up) * math.cos(around), aspect=-WIDTH / HEIGHT,
        angle=2 * math.degrees(math.atan(slope * WIDTH / HEIGHT)), sky=sky, index=INDEX))
    run(["povray", "+Iglass.pov", "+Opov.exr", "+FE", f"+W{WIDTH}", f"+H{HEIGHT}", "+A0.0", "+AM1", f"+R{SAMPLES}",
         "-J", "-D"], cwd=folder)
    return floats(folder / "pov.exr")


def by_chromeball(program, sky, index, path):
    run([program, "preview", sky, "--from", "latlong", "--input-space", "scene_linear", "--material", "glass",
         "--ior", index, "--background", "--orbit", f"{AZIMUTH},{ELEVATION},{DISTANCE}", "--fov", FOV, "--size",
         f"{WIDTH},{HEIGHT}", "--samples", SAMPLES * SAMPLES, "--float", "-o", path, "--quiet"])
    return floats(path)


def compressed(x):
    return np.maximum(x, 0) / (1 + np.maximum(x, 0))


def psnr(a, b):
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    focal = HEIGHT / 2 / math.tan(math.radians(FOV / 2))
    radius = focal * math.tan(math.asin(1 / DISTANCE))
    inside = np.hypot(x - WIDTH / 2, y - HEIGHT / 2) < radius - 1
    return -10 * math.log10(np.mean((compressed(a) - compressed(b))[inside] ** 2))


def write_picture(path, image):
    image = np.ascontiguousarray(np.clip(image, 0, 1) ** (1 / 2.2))
    buffer = oiio.ImageBuf(oiio.ImageSpec(image.shape[1], image.shape[0], 3, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), image)
    buffer.write(str(path), "uint8")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--program", type=pathlib.Path, required=True)
    arguments.add_argument("--keep", type=pathlib.Path)
    arguments.add_argument("maps", nargs="+", type=pathlib.Path)
    o = arguments.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for path in o.maps:
            # POV-Ray reads EXR of halves.
            sky = folder / "sky.exr"
            run(["oiiotool", path, "--ch", "R,G,B", "-d", "half", "-o", sky])
            pov = by_povray(sky, folder)
            own = by_chromeball(o.program.resolve(), sky, INDEX, folder / "own.exr")
            other = by_chromeball(o.program.resolve(), sky, OTHER_INDEX, folder / "other.exr")
            print(f"{path.stem:12} {psnr(own, pov):6.2f} dB; of index {OTHER_INDEX}: {psnr(other, pov):6.2f} dB", flush=True)
            if o.keep:
                o.keep.mkdir(parents=True, exist_ok=True)
                write_picture(o.keep / f"{path.stem}.png", np.concatenate([pov, own, 4 * np.abs(pov - own)], 1))


main()
