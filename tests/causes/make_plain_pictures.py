#!/usr/bin/env python3
"""Writes a recording without rig.toml of two cameras, whose pictures have one grey level, for rows about sweeps of a wand.

    make_plain_pictures.py FOLDER LEVEL
"""

import os
import struct
import sys
import zlib

WIDTH, HEIGHT, NUM_PICTURES = 64, 48, 12


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def main():
    folder, level = sys.argv[1], int(sys.argv[2])
    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    body = zlib.compress((b"\0" + bytes([level]) * WIDTH) * HEIGHT)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
    for camera in ("north", "south"):
        frames = os.path.join(folder, camera, "frames")
        os.makedirs(frames)
        for number in range(NUM_PICTURES):
            with open(os.path.join(frames, f"{number:06}.png"), "wb") as stream:
                stream.write(png)


main()
