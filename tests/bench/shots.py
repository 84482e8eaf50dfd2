#!/usr/bin/env python3
"""Shots: frames a second here and elsewhere, what a shot cannot do without, memory, and runs that are killed.

    shots.py --program build/release/apps/chromeball/chromeball --floor build/release/tests/bench/shot_floor PLATE FOCAL
    shots.py --program ... --measure memory|kills PLATE FOCAL

PLATE is a linear EXR with a mirror ball, FOCAL its focal length in pixels. Of it frames of 4096x2160 are made in a
folder (--folder, kept if told), in which the picture drifts by some pixels a frame, with grain: half floats, --codec.

speed: rounds in turn of chromeball with 1 and 2 jobs, ffmpeg's v360 with a fixed crop, 1 and 2 threads, and the floor:
the ball's rows decoded twice and the map encoded. Wall and CPU time. memory: the largest resident set over 10, 100 and
1000 frames (320 pixels wide, all the same file) and of 4K frames with 2 jobs. kills: 30 runs ended by SIGKILL at random
moments, resumed, compared byte by byte with one that was not. Needs python3-opencv, python3-openimageio; ffmpeg if there.
"""
import argparse
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import statistics
import subprocess
import tempfile
import time

import cv2
import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT, FIRST = 4096, 2160, 1001


def floats(path):
    buffer = oiio.ImageBuf(str(path))
    names = list(buffer.spec().channelnames)
    pixels = buffer.get_pixels(oiio.FLOAT)
    return np.ascontiguousarray(np.stack([pixels[..., names.index(c)] for c in "RGB"], -1))


def write(path, pixels, codec):
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "half")
    spec.attribute("compression", codec)
    out = oiio.ImageOutput.create(str(path))
    if not out or not out.open(str(path), spec) or not out.write_image(np.ascontiguousarray(pixels, np.float32)):
        raise OSError(oiio.geterror())
    out.close()


def make_frames(plate, folder, codec, count):
    """4K frames; returns by how much larger they are than the plate."""
    picture = floats(plate)
    scale = WIDTH / picture.shape[1]
    picture = cv2.resize(picture, (WIDTH, round(picture.shape[0] * scale)), interpolation=cv2.INTER_CUBIC)
    top = max(0, (picture.shape[0] - HEIGHT) // 2)
    picture = np.maximum(picture[top:top + HEIGHT], 0)
    for i in range(count):
        path = folder / ("p.%d.exr" % (FIRST + i))
        if path.exists():
            continue
        drift = np.float32([[1, 0, 1.7 * i + 3 * np.sin(i / 9)], [0, 1, -0.8 * i + 2 * np.cos(i / 13)]])
        moved = cv2.warpAffine(picture, drift, (WIDTH, HEIGHT), borderMode=cv2.BORDER_REFLECT)
        grain = np.random.default_rng(i).standard_normal(moved.shape, dtype=np.float32)
        write(path, moved * (1 + 0.01 * grain), codec)
    return scale


def peak_mib(pid):
    """The largest resident set so far; wait4's would be at least that of this very script."""
    try:
        lines = pathlib.Path("/proc/%d/status" % pid).read_text().splitlines()
        return next((int(l.split()[1]) / 1024 for l in lines if l.startswith("VmHWM")), 0)
    except OSError:
        return 0


def timed(words):
    """Wall seconds, CPU seconds and the largest resident set, MiB, of a process."""
    start, peak = time.time(), 0
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        process = subprocess.Popen([str(w) for w in words], stdout=out, stderr=err)
        pid = 0
        while not pid:
            peak = max(peak, peak_mib(process.pid))
            time.sleep(0.01)
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        seconds = time.time() - start
        process.returncode = status
        out.seek(0), err.seek(0)
        if status:
            raise RuntimeError("%s: status %d: %s" % (words[0], status, err.read()[-500:]))
        return {"wall": seconds, "cpu": usage.ru_utime + usage.ru_stime, "mib": peak, "out": out.read()}


def shot(args, plates, frames, out, jobs, *more):
    """The words that convert a shot."""
    return [args.program, "shot", plates, "--frames", frames, "-o", out / "m.####.exr", "--focal-px", args.focal_px,
            "--jobs", jobs, "--quiet", *more]


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def speed(args, folder):
    frames = "%d-%d" % (FIRST, FIRST + args.count - 1)
    plates = folder / "p.####.exr"
    size = ["--size", args.size]
    report = folder / "report.json"
    subprocess.run([str(w) for w in shot(args, plates, frames, fresh(folder / "o"), 1, *size, "--report", report)], check=True)
    outlines = [f["outline"] for f in json.loads(report.read_text())["frames"] if f["outline"]]
    middle = outlines[len(outlines) // 2]
    side = int(2 * max(middle["a"], middle["b"])) // 2 * 2
    left, top = int(middle["cx"] - side / 2), int(middle["cy"] - side / 2)
    print("ball %.0f pixels across, %d of %d frames found" % (side, len(outlines), args.count))
    rows = [top - 12, top + side + 12]

    runs = {}
    for jobs in (1, 2):
        runs["chromeball, jobs %d" % jobs] = lambda jobs=jobs: timed(shot(args, plates, frames, fresh(folder / "o"), jobs, *size))
        if shutil.which("ffmpeg"):
            crop = "crop=%d:%d:%d:%d,v360=ball:e:interp=linear:w=%d:h=%d" % (side, side, left, top, 2 * args.size, args.size)
            runs["ffmpeg v360, threads %d" % jobs] = lambda jobs=jobs, crop=crop: timed(
                ["ffmpeg", "-v", "error", "-y", "-threads", jobs, "-start_number", FIRST, "-i", folder / "p.%04d.exr",
                 "-filter_threads", jobs, "-vf", crop, "-threads", jobs, "-pix_fmt", "rgb48be", fresh(folder / "f") / "f.%04d.png"])
    if args.floor:
        runs["floor: rows decoded twice, map encoded"] = lambda: timed(
            [args.floor, plates, FIRST, FIRST + args.count - 1, *rows, args.size, fresh(folder / "o") / "m.####.exr"])
    figures = {name: [] for name in runs}
    for _ in range(args.rounds):
        for name, run in runs.items():
            figures[name].append(run())
    reference = figures["chromeball, jobs 1"]
    for name, all_runs in figures.items():
        wall, cpu = (statistics.median(r[key] for r in all_runs) / args.count for key in ("wall", "cpu"))
        ratio = statistics.median(r["cpu"] / o["cpu"] for r, o in zip(all_runs, reference))
        print("%-42s %6.1f frames/s wall, CPU %6.1f ms a frame, %5.2f of chromeball's; %4.0f MiB" %
              (name, 1 / wall, 1e3 * cpu, ratio, max(r["mib"] for r in all_runs)), all_runs[0]["out"].strip())


def memory(args, folder):
    frames = "%d-%d" % (FIRST, FIRST + min(args.count, 8) - 1)
    run = timed(shot(args, folder / "p.####.exr", frames, fresh(folder / "o"), 2))
    print("4096x2160, 2 jobs: %.0f MiB" % run["mib"])
    small = fresh(folder / "small")
    scale = 320 / WIDTH
    pixels = cv2.resize(floats(folder / ("p.%d.exr" % FIRST)), (320, round(HEIGHT * scale)), interpolation=cv2.INTER_AREA)
    write(small / "one.exr", pixels, "zip")
    for i in range(1000):
        os.link(small / "one.exr", small / ("s.%d.exr" % (FIRST + i)))
    for count in (10, 100, 1000):
        run = timed([args.program, "shot", small / "s.####.exr", "--frames", "%d-%d" % (FIRST, FIRST + count - 1), "-o",
                     fresh(folder / "o") / "m.####.exr", "--focal-px", args.focal_px * scale, "--jobs", 2, "--size", 32,
                     "--quiet", "--report", folder / "r.json", "--report", folder / "r.html"])
        print("%4d frames of 320 pixels: %.1f MiB" % (count, run["mib"]))


def digests(folder):
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest()
            for p in sorted(folder.rglob("*")) if p.is_file() and ".chromeball" not in p.parts}


def kills(args, folder):
    frames = "%d-%d" % (FIRST, FIRST + min(args.count, 16) - 1)
    words = lambda out: [str(w) for w in shot(args, folder / "p.####.exr", frames, out, 2, "--size", 64)]
    start = time.time()
    subprocess.run(words(fresh(folder / "whole")), check=True)
    whole, want = time.time() - start, digests(folder / "whole")
    chance, bad, killed = random.Random(1), 0, 0
    for _ in range(30):
        out = fresh(folder / "killed")
        process = subprocess.Popen(words(out))
        time.sleep(chance.uniform(0.02, 0.95 * whole))
        killed += process.poll() is None
        process.send_signal(signal.SIGKILL)
        process.wait()
        resumed = subprocess.run(words(out)).returncode
        strays = [p for p in out.rglob("*") if p.suffix in (".part", ".tmp")]
        bad += bool(resumed or strays or digests(out) != want)
    print("30 runs, %d of them killed (the others were done), resumed: %d not as one that was not" % (killed, bad))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plate", metavar="PLATE", type=pathlib.Path)
    parser.add_argument("focal", metavar="FOCAL", type=float)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--floor", type=pathlib.Path)
    parser.add_argument("--measure", choices=("speed", "memory", "kills"), default="speed")
    parser.add_argument("--folder", type=pathlib.Path, help="for the frames (default: one that vanishes)")
    parser.add_argument("--codec", default="dwaa", help="of the frames: dwaa, zip, zips, piz, ...")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--rounds", type=int, default=3)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as vanishing:
        folder = args.folder or pathlib.Path(vanishing)
        folder.mkdir(parents=True, exist_ok=True)
        args.focal_px = args.focal * make_frames(args.plate, folder, args.codec, args.count)
        {"speed": speed, "memory": memory, "kills": kills}[args.measure](args, folder)


if __name__ == "__main__":
    main()
