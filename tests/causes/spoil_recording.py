#!/usr/bin/env python3
"""Spoils a recording as users do, for the rows of the table of causes.

    spoil_recording.py RIG.toml FACTOR|invert|opengl|yup    translations in another unit, or extrinsics of another convention
    spoil_recording.py RIG.toml table|pit                   origin 0.74 m above the floor, or 0.4 m below it
    spoil_recording.py CAMERA black|small|background        silhouettes without anybody, or pictures of half the size
    spoil_recording.py CAMERA video|cut|zeros|lost          frames as an uncompressed video, whole, cut off, with zeros inside, or
                                                            without bytes for pictures 4 to 6
"""

import os
import re
import shutil
import struct
import sys

import make_recording


def product(a, b):
    return [sum(a[3 * i + k] * b[3 * k + j] for k in range(3)) for i in range(3) for j in range(3)]


def spoil(how, rotation, translation):
    if how == "invert":
        rotation = [rotation[3 * j + i] for i in range(3) for j in range(3)]
        return rotation, [-sum(rotation[3 * i + k] * translation[k] for k in range(3)) for i in range(3)]
    if how == "opengl":
        return rotation[:3] + [-x for x in rotation[3:]], [translation[0], -translation[1], -translation[2]]
    if how == "yup":
        return product(rotation, [1, 0, 0, 0, 0, -1, 0, 1, 0]), translation
    if how in ("table", "pit"):
        origin_m = 0.74 if how == "table" else -0.4
        return rotation, [translation[i] + origin_m * rotation[3 * i + 2] for i in range(3)]
    return rotation, [float(how) * x for x in translation]


def spoil_rig(path, how):
    with open(path, encoding="ascii") as stream:
        text = stream.read()

    def replace(match):
        numbers = [[float(x) for x in group.split(",")] for group in match.groups()]
        rotation, translation = spoil(how, *numbers)
        return f"rotation = {rotation}\ntranslation = {translation}"

    with open(path, "w", encoding="ascii") as stream:
        stream.write(re.sub(r"rotation = \[(.*)\]\ntranslation = \[(.*)\]", replace, text))


def spoil_pictures(camera, how):
    kind = "background" if how == "background" else "silhouettes"
    channels = 3 if how == "background" else 1
    if how != "black":
        make_recording.WIDTH, make_recording.HEIGHT = 80, 60
    row = bytes(channels * make_recording.WIDTH)
    for name in os.listdir(os.path.join(camera, kind)):
        make_recording.write_png(os.path.join(camera, kind, name), [row] * make_recording.HEIGHT, channels)


def write_video(path, num_pictures, lost=()):
    """AVI of grey pictures without compression. A lost one is a chunk without bytes."""
    width, height = make_recording.WIDTH, make_recording.HEIGHT
    size = 3 * width * height

    def chunk(kind, data):
        return kind + struct.pack("<I", len(data)) + data

    head = chunk(b"avih", struct.pack("<14I", 50000, 0, 0, 16, num_pictures, 0, 1, size, width, height, 0, 0, 0, 0))
    stream = chunk(b"strh", b"vidsDIB " + struct.pack("<10I4H", 0, 0, 0, 1, 20, 0, num_pictures, size, 0, 0, 0, 0, width, height))
    stream += chunk(b"strf", struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, size, 0, 0, 0, 0))
    index, pictures = b"", b""
    for i in range(num_pictures):
        content = b"" if i in lost else bytes([100]) * size
        index += b"00db" + struct.pack("<III", 16, 4 + len(pictures), len(content))
        pictures += chunk(b"00db", content)
    body = chunk(b"LIST", b"hdrl" + head + chunk(b"LIST", b"strl" + stream)) + chunk(b"LIST", b"movi" + pictures)
    with open(path, "wb") as file:
        file.write(chunk(b"RIFF", b"AVI " + body + chunk(b"idx1", index)))


def spoil_video(camera, how):
    folder = os.path.join(camera, "frames")
    num_pictures = len(os.listdir(folder))
    shutil.rmtree(folder)
    write_video(folder + ".avi", num_pictures, range(4, 7) if how == "lost" else ())
    if how in ("video", "lost"):
        return
    middle = os.path.getsize(folder + ".avi") // 2
    if how == "cut":
        os.truncate(folder + ".avi", middle - 3 * make_recording.WIDTH * make_recording.HEIGHT // 2)
        return
    with open(folder + ".avi", "r+b") as file:
        file.seek(middle)
        file.write(bytes(6 * make_recording.WIDTH * make_recording.HEIGHT))


if __name__ == "__main__":
    if sys.argv[2] in ("video", "cut", "zeros", "lost"):
        spoil_video(sys.argv[1], sys.argv[2])
        sys.exit()
    (spoil_rig if sys.argv[1].endswith(".toml") else spoil_pictures)(sys.argv[1], sys.argv[2])
