#!/usr/bin/env python3
"""Writes a small recording for the rows of the table of causes: a person of five balls before four cameras, with silhouettes.

    make_recording.py FOLDER [--frames N] [--background]      with --background instead of silhouettes: pictures of the empty room
"""

import argparse
import math
import os
import struct
import zlib

WIDTH, HEIGHT, FOCAL_PX = 160, 120, 120.0
PERSON = [((0.0, 0.0, 0.45), 0.3), ((0.0, 0.0, 0.95), 0.3), ((0.35, 0.1, 1.25), 0.14), ((0.1, -0.3, 0.3), 0.2), ((0.0, 0.0, 1.5), 0.18)]
NAMES = ["north", "east", "south", "west"]


def write_png(path, rows, channels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2 if channels == 3 else 0, 0, 0, 0)
    body = b"".join(b"\0" + bytes(row) for row in rows)
    with open(path, "wb") as stream:
        stream.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b""))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def pose(index):
    """Rotation (rows) and translation of camera_from_site."""
    angle = 0.3 + math.pi / 2 * index
    centre = [3.0 * math.cos(angle), 3.0 * math.sin(angle), 1.0 + 0.4 * index]
    ahead = unit([-centre[0], -centre[1], 0.8 - centre[2]])
    right = unit(cross(ahead, [0.0, 0.0, 1.0]))
    rows = [right, cross(ahead, right), ahead]
    return rows, [-sum(r[k] * centre[k] for k in range(3)) for r in rows]


def silhouette(rows, translation):
    picture = [bytearray(WIDTH) for _ in range(HEIGHT)]
    for centre, radius in PERSON:
        x, y, z = (sum(r[k] * centre[k] for k in range(3)) + t for r, t in zip(rows, translation))
        u, v, size = FOCAL_PX * x / z + WIDTH / 2 - 0.5, FOCAL_PX * y / z + HEIGHT / 2 - 0.5, FOCAL_PX * radius / z
        for row in range(max(0, math.ceil(v - size)), min(HEIGHT - 1, math.floor(v + size)) + 1):
            half = math.sqrt(size * size - (row - v) ** 2)
            left, right = max(0, math.ceil(u - half)), min(WIDTH - 1, math.floor(u + half))
            picture[row][left:right + 1] = b"\xff" * max(0, right + 1 - left)
    return picture


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--frames", type=int, default=1)
    parser.add_argument("--background", action="store_true")
    arguments = parser.parse_args()
    os.makedirs(arguments.folder)
    with open(os.path.join(arguments.folder, "rig.toml"), "w", encoding="ascii") as rig:
        rig.write('units = "m"\nrate_hz = 20\n')
        for index, name in enumerate(NAMES):
            rows, translation = pose(index)
            rig.write(f'[[camera]]\nname = "{name}"\nwidth = {WIDTH}\nheight = {HEIGHT}\nfx = {FOCAL_PX}\nfy = {FOCAL_PX}\n'
                      f"cx = {WIDTH / 2 - 0.5}\ncy = {HEIGHT / 2 - 0.5}\nrotation = {[x for r in rows for x in r]}\n"
                      f"translation = {translation}\n")
            camera = os.path.join(arguments.folder, name)
            mask = silhouette(rows, translation)
            for kind in ("frames", "background" if arguments.background else "silhouettes"):
                os.makedirs(os.path.join(camera, kind))
            for number in range(arguments.frames):
                file = f"{number:06d}.png"
                coloured = [[value for pixel in row for value in ((200, 60, 60) if pixel else (90, 110, 100))] for row in mask]
                write_png(os.path.join(camera, "frames", file), coloured, 3)
                if arguments.background:
                    write_png(os.path.join(camera, "background", file), [[90, 110, 100] * WIDTH] * HEIGHT, 3)
                else:
                    write_png(os.path.join(camera, "silhouettes", file), mask, 1)


if __name__ == "__main__":
    main()
