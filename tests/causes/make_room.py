#!/usr/bin/env python3
"""Writes a recording of a room for the rows of backgrounds.toml: a coloured box before two cameras, as a person who walks about.

    make_room.py FOLDER [--frames N] [--half] [--plate empty|person|dark] [--masks WIDTHxHEIGHT]

--half halves width and height. --plate writes background.png: of the empty room, with somebody in it, or in a quarter of the light. --masks writes silhouettes of this size.
"""

import argparse
import os
import struct
import zlib

WIDTH, HEIGHT = 160, 120
PLACES = [8, 60, 34, 120]  # left edges of the person; a plate with a person has it at another one
PLATE_PLACE = 90


def write_png(path, rows, channels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", len(rows[0]) // channels, len(rows), 8, 2 if channels == 3 else 0, 0, 0, 0)
    body = b"".join(b"\0" + bytes(row) for row in rows)
    with open(path, "wb") as stream:
        stream.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(body, 1)) + chunk(b"IEND", b""))


def picture(left, scale):
    """The room, and the person at `left` unless that is None. `scale`: 2 for half the width and height."""
    rows = []
    for y in range(0, HEIGHT, scale):
        row = bytearray(bytes((150, 150 + y // 8, 140)) * (WIDTH // scale))
        if left is not None and 30 <= y < 105:
            row[3 * left // scale:3 * (left + 26) // scale] = bytes((160, 40, 60) if y < 70 else (40, 45, 80)) * (26 // scale)
        rows.append(row)
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--frames", type=int, default=1)
    parser.add_argument("--plate", choices=["empty", "person", "dark"])
    parser.add_argument("--half", action="store_true")
    parser.add_argument("--masks")
    options = parser.parse_args()
    scale = 2 if options.half else 1
    os.makedirs(options.folder)
    with open(os.path.join(options.folder, "rig.toml"), "w", encoding="utf-8") as rig:
        rig.write("units = \"m\"\nrate_hz = 25\n[bounds]\nmin = [-1, -1, 0]\nmax = [1, 1, 2]\n")
        for name, rotation in (("north", "[-1, 0, 0, 0, 0, -1, 0, -1, 0]"), ("east", "[0, 1, 0, 0, 0, -1, -1, 0, 0]")):
            rig.write(f"[[camera]]\nname = \"{name}\"\nwidth = {WIDTH // scale}\nheight = {HEIGHT // scale}\nfx = 130\nfy = 130\ncx = 79.5\ncy = 59.5\n"
                      f"rotation = {rotation}\ntranslation = [0, 1, 3]\n")
    pictures = [picture(left, scale) for left in PLACES]
    for name in ("north", "east"):
        folder = os.path.join(options.folder, name)
        os.makedirs(os.path.join(folder, "frames"))
        for i in range(options.frames):
            path = os.path.join(folder, "frames", f"{i:06}.png")
            if i < len(pictures):
                write_png(path, pictures[i], 3)
            else:
                os.link(os.path.join(folder, "frames", f"{i % len(pictures):06}.png"), path)
        if options.plate:
            left = PLATE_PLACE if options.plate == "person" else None
            plate = picture(left, scale)
            if options.plate == "dark":
                plate = [bytes(value // 4 for value in row) for row in plate]
            write_png(os.path.join(folder, "background.png"), plate, 3)
        if options.masks:
            width, height = map(int, options.masks.split("x"))
            os.makedirs(os.path.join(folder, "silhouettes"))
            write_png(os.path.join(folder, "silhouettes", "000000.png"), [bytearray(width)] * height, 1)


if __name__ == "__main__":
    main()
