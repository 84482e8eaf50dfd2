#!/usr/bin/env python3
"""How well a grey ball beside the mirror ball gives back the light that was clipped.

    grey_ball.py --program build/release/apps/chromeball/chromeball PLATE.exr X,Y,R [convert's options ...]

A linear plate whose sun is whole is clipped where a part of its mirror ball (--clipped) lies above. The maps of the
clipped plate, without and with --grey-ball X,Y,R, are held against that of the whole one: irradiance of surfaces of all
directions, mean and largest magnitude of the relative error, and that of the sum over all. Needs python3-openimageio.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio


def irradiance(path):
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3].astype(float)
    height, width = pixels.shape[:2]
    lat = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    lon = np.pi * (1 - 2 * (np.arange(width) + 0.5) / width)
    up = np.broadcast_to(np.sin(lat)[:, None], (height, width))
    across = np.cos(lat)[:, None]
    d = np.stack([across * np.sin(lon), up, across * np.cos(lon)], -1).reshape(-1, 3)
    sr = np.repeat(np.cos(lat) * (np.pi / height) * (2 * np.pi / width), width)
    return np.maximum(d[::7] @ d.T, 0) @ (pixels.reshape(-1, 3) * sr[:, None])


def convert(o, plate, out, more=()):
    subprocess.run([o.program, "convert", str(plate), "-o", str(out), "--size", "128", "--float", "--quiet", *o.options,
                    *more], check=True)
    return irradiance(out)


def ball_mask(o, shape, options):
    found = json.loads(subprocess.run([o.program, "detect", o.plate, *options], check=True, capture_output=True,
                                      text=True).stdout)["outline"]
    y, x = np.mgrid[:shape[0], :shape[1]] + 0.5
    turn = np.radians(found["angle"])
    dx, dy = x - found["cx"], y - found["cy"]
    u, v = dx * np.cos(turn) + dy * np.sin(turn), dy * np.cos(turn) - dx * np.sin(turn)
    return (u / found["a"]) ** 2 + (v / found["b"]) ** 2 < 1


def main():
    command = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    command.add_argument("plate")
    command.add_argument("grey", metavar="X,Y,R")
    command.add_argument("--program", default="chromeball")
    command.add_argument("--clipped", default="0.001,0.005", help="parts of the ball")
    command.add_argument("--reflectance", default="0.18")
    o, o.options = command.parse_known_args()
    buffer = oiio.ImageBuf(o.plate)
    pixels = buffer.get_pixels(oiio.FLOAT)
    inside = pixels[ball_mask(o, pixels.shape, o.options)][:, :3].max(-1)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        whole = convert(o, o.plate, work / "whole.exr")
        for part in map(float, o.clipped.split(",")):
            level = float(np.float16(np.quantile(inside, 1 - part)))
            out = oiio.ImageBuf(buffer.spec())
            out.set_pixels(oiio.ROI(), np.minimum(pixels, level))
            out.write(str(work / "clipped.exr"), oiio.HALF)
            grey = ["--grey-ball", o.grey, "--grey-reflectance", o.reflectance, "--clip", str(level)]
            for name, more in (("clipped", []), ("with the grey ball", grey)):
                light = convert(o, work / "clipped.exr", work / "map.exr", more)
                error = np.abs(light / whole - 1)
                print(f"{pathlib.Path(o.plate).name} {100 * part:.1f} % of the ball from {level:.3g} on, {name:18}: "
                      f"mean {100 * error.mean():.1f} %, largest {100 * error.max():.1f} %, "
                      f"sum {100 * (light.sum() / whole.sum() - 1):+.1f} %", flush=True)


if __name__ == "__main__":
    main()
