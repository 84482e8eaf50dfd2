#!/usr/bin/env python3
"""Merging brackets, here and elsewhere, against the linear picture the photos were made from.

    brackets.py --program build/release/apps/chromeball/chromeball DATA/index.json

DATA/index.json has items with "set": "C", "linear_exr" and "brackets": {name: [{"file", "exposure_time_s",
"linear_gain"}]}; paths are relative to it. Each bracket is merged with its EXIF, and with its EXIF stripped; beside
it cv2.createMergeDebevec with the curve of cv2.createCalibrateDebevec and exact times, a merge by hat weights of
decoded sRGB, and pfshdrcalibrate (pfstools), where they are installed.

Errors are log2 of merged over true light with one scale a picture taken out, over pixels that some photo shows
between 2 % and 90 % of white. Needs python3-opencv, python3-openimageio, exiftool; pfstools if there.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile
import time

import cv2
import numpy as np
import OpenImageIO as oiio


def floats(path):
    buffer = oiio.ImageBuf(str(path))
    names = list(buffer.spec().channelnames)
    pixels = buffer.get_pixels(oiio.FLOAT)
    return np.stack([pixels[..., names.index(c)] for c in "RGB"], -1)


def judge(picture, truth, gains):
    v = truth[..., None] * np.array(gains)
    well = ((v > 0.02) & (v < 0.9)).all(2).any(-1) & (truth > 0).all(-1)
    error = np.log2(np.maximum(picture, 1e-9) / np.maximum(truth, 1e-9))[well]
    error -= np.median(error)
    return {"rms": float(np.sqrt(np.mean(np.clip(error, -10, 10) ** 2))),
            "median": float(np.median(np.abs(error))),
            "colour": float(np.ptp(np.median(error, 0)))}


def decoded(path):
    v = cv2.imread(str(path))[..., ::-1].astype(np.float32) / 255
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def by_hats(paths, times):
    total = weight = 0
    for path, t in zip(paths, times):
        v = decoded(path)
        w = np.maximum(1 - np.abs(2 * v - 1), 1e-4) * t
        total, weight = total + w * v / t, weight + w
    return total / weight


def by_opencv(paths, times):
    photos = [cv2.imread(str(p)) for p in paths]
    times = np.array(times, np.float32)
    curve = cv2.createCalibrateDebevec(samples=300).process(photos, times)
    return cv2.createMergeDebevec().process(photos, times, curve)[..., ::-1]


def by_pfstools(paths, times, work):
    """Robertson's method, as pfshdrcalibrate has it; through an EXR."""
    hdrgen = work / "photos.hdrgen"
    hdrgen.write_text("".join(f"{p} {1 / t} 1 100 0\n" for p, t in zip(paths, times)))
    out = work / "pfs.exr"
    line = f"pfsinhdrgen {hdrgen} | pfshdrcalibrate -r linear --bpp 8 | pfsout {out}"
    done = subprocess.run(["bash", "-o", "pipefail", "-c", line], capture_output=True, text=True)
    if done.returncode or not out.exists():
        raise OSError(done.stderr.strip().splitlines()[-1] if done.stderr else "pfstools failed")
    return floats(out)


def by_chromeball(program, paths, work):
    out = work / "chromeball.exr"
    subprocess.run([program, "merge", *map(str, paths), "-o", str(out), "--quiet",
                    "--output-space", "lin_rec709"], check=True, capture_output=True, text=True)
    return floats(out)


def stripped(paths, work):
    bare = []
    for k, path in enumerate(paths):
        bare.append(work / f"bare{k}{path.suffix}")
        shutil.copyfile(path, bare[-1])
    subprocess.run(["exiftool", "-q", "-overwrite_original", "-all=", *map(str, bare)], check=True)
    return bare


def main():
    command = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    command.add_argument("index", type=pathlib.Path)
    command.add_argument("--program", default="chromeball")
    o = command.parse_args()
    root = o.index.parent
    print(f"{'bracket':12} {'merged by':24} {'rms':>7} {'median':>7} {'colour':>7} {'seconds':>8}")
    for item in json.loads(o.index.read_text())["items"]:
        if item.get("set") != "C":
            continue
        truth = floats(root / item["linear_exr"])
        for name, takes in item["brackets"].items():
            paths = [root / t["file"] for t in takes]
            gains = [t["linear_gain"] for t in takes]
            times = [g / max(gains) for g in gains]  # time, aperture and ISO together
            with tempfile.TemporaryDirectory() as folder:
                work = pathlib.Path(folder)
                bare = stripped(paths, work)
                for who, merge in (
                    ("chromeball", lambda: by_chromeball(o.program, paths, work)),
                    ("chromeball, no EXIF", lambda: by_chromeball(o.program, bare, work)),
                    ("OpenCV MergeDebevec", lambda: by_opencv(paths, times)),
                    ("pfshdrcalibrate", lambda: by_pfstools(paths, times, work)),
                    ("hats, sRGB decoded", lambda: by_hats(paths, times)),
                ):
                    start = time.time()
                    try:
                        figures = judge(merge(), truth, gains)
                        line = "".join(f" {figures[k]:7.4f}" for k in ("rms", "median", "colour"))
                        line += f" {time.time() - start:8.2f}"
                    except (OSError, subprocess.CalledProcessError) as error:
                        line = f"  {getattr(error, 'stderr', None) or error}".rstrip()
                    print(f"{item['id'] + ' ' + name:12} {who:24}{line}", flush=True)


if __name__ == "__main__":
    main()
