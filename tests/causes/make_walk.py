#!/usr/bin/env python3
"""Writes a recording of a person of balls who walks through a room of six cameras, with silhouettes, for the rows of
calibrate_refine.toml. rig.toml is what a calibration said before cameras moved.

    make_walk.py FOLDER [--frames N] [--stand] [--turn CAMERA DEGREES] [--turn-all DEGREES] [--late CAMERA]
              [--flip CAMERA|all hflip|vflip] [--zoom FACTOR]
"""

import argparse
import math
import os

import make_recording

WIDTH, HEIGHT, FOCAL_PX = 320, 240, 250.0
NAMES = ["north", "north_west", "south_west", "south", "south_east", "north_east"]
BALLS = [((0.0, 0.0, 0.16), 0.15), ((0.0, 0.0, 0.45), 0.17), ((0.0, 0.0, 0.95), 0.25), ((0.05, 0.0, 1.5), 0.14), ((0.0, 0.0, 1.25), 0.2)]
FRAME_S = 0.1


def balls_at(time_s):
    x, y = 0.6 * math.sin(0.9 * time_s), 0.6 * math.sin(0.7 * time_s + 1.0)
    swing, turn = 0.35 * math.sin(4.0 * time_s), 0.5 * time_s
    moving = BALLS + [((0.3, swing, 1.1 + 0.3 * math.sin(time_s)), 0.08), ((-0.3, -swing, 1.0), 0.08), ((0.1, -0.7 * swing, 0.12), 0.09)]
    c, s = math.cos(turn), math.sin(turn)
    return [((x + c * p[0] - s * p[1], y + s * p[0] + c * p[1], p[2]), r) for p, r in moving]


def pose(index, turn_rad=0.0):
    """Rotation (rows) and translation of camera_from_site of a camera that turned about the vertical through its centre."""
    angle = 2.0 * math.pi * index / len(NAMES)
    centre = [3.2 * math.cos(angle), 3.2 * math.sin(angle), 1.1 + 1.2 * (index % 2)]
    ahead = make_recording.unit([-centre[0], -centre[1], 0.8 - centre[2]])
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    ahead = [c * ahead[0] - s * ahead[1], s * ahead[0] + c * ahead[1], ahead[2]]
    right = make_recording.unit(make_recording.cross(ahead, [0.0, 0.0, 1.0]))
    rows = [right, make_recording.cross(ahead, right), ahead]
    return rows, [-sum(r[k] * centre[k] for k in range(3)) for r in rows]


def silhouette(balls, rows, translation, focal_px):
    """A pixel is inside a ball if its ray comes as near to the centre: (ray . c)^2 >= |ray|^2 (|c|^2 - r^2)."""
    picture = [bytearray(WIDTH) for _ in range(HEIGHT)]
    for centre, radius in balls:
        x, y, z = (sum(r[k] * centre[k] for k in range(3)) + t for r, t in zip(rows, translation))
        k = x * x + y * y + z * z - radius * radius
        for row in range(HEIGHT):
            v = (row - (HEIGHT - 1) / 2) / focal_px
            a, b, c = x * x - k, x * (y * v + z), (y * v + z) ** 2 - (v * v + 1.0) * k
            if b * b < a * c:
                continue
            root = math.sqrt(b * b - a * c)
            left, right = sorted(((-b + root) / a, (-b - root) / a))
            first = max(0, math.ceil(left * focal_px + (WIDTH - 1) / 2))
            last = min(WIDTH - 1, math.floor(right * focal_px + (WIDTH - 1) / 2))
            picture[row][first:last + 1] = b"\xff" * max(0, last + 1 - first)
    return picture


def flipped(picture, camera, flip):
    """Picture of a camera in a recording with these two values of --flip: a camera or all, and ffmpeg's filter."""
    if flip[0] not in (camera, "all"):
        return picture
    return [row[::-1] for row in picture] if flip[1] == "hflip" else picture[::-1]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--stand", action="store_true")
    parser.add_argument("--turn", nargs=2, default=["", "0"])
    parser.add_argument("--turn-all", type=float, default=0.0)
    parser.add_argument("--late", default="")
    parser.add_argument("--flip", nargs=2, default=["", ""])
    parser.add_argument("--zoom", type=float, default=1.0)
    options = parser.parse_args()
    make_recording.WIDTH, make_recording.HEIGHT = WIDTH, HEIGHT
    os.makedirs(options.folder)
    grey = os.path.join(options.folder, "grey.png")
    make_recording.write_png(grey, [bytes([110]) * WIDTH] * HEIGHT, 1)
    with open(os.path.join(options.folder, "rig.toml"), "w", encoding="ascii") as rig:
        rig.write('units = "m"\nrate_hz = 10\n')
        for index, name in enumerate(NAMES):
            rows, translation = pose(index)
            rig.write(f'[[camera]]\nname = "{name}"\nwidth = {WIDTH}\nheight = {HEIGHT}\nfx = {FOCAL_PX}\nfy = {FOCAL_PX}\n'
                      f"cx = {WIDTH / 2 - 0.5}\ncy = {HEIGHT / 2 - 0.5}\nrotation = {[x for r in rows for x in r]}\n"
                      f"translation = {translation}\n")
            degrees = (float(options.turn[1]) if name == options.turn[0] else 0.0) + options.turn_all * (1, -1, 0.5, -0.7, 0.9, -0.4)[index]
            rows, translation = pose(index, math.radians(degrees))
            for kind in ("frames", "silhouettes"):
                os.makedirs(os.path.join(options.folder, name, kind))
            for number in range(options.frames):
                instant = 0 if options.stand else number - (1 if name == options.late else 0)
                file = f"{number:06d}.png"
                os.link(grey, os.path.join(options.folder, name, "frames", file))
                mask = silhouette(balls_at(FRAME_S * instant), rows, translation, FOCAL_PX * options.zoom)
                mask = flipped(mask, name, options.flip)
                make_recording.write_png(os.path.join(options.folder, name, "silhouettes", file), mask, 1)


if __name__ == "__main__":
    main()
