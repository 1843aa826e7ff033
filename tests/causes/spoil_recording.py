#!/usr/bin/env python3
"""Spoils a recording as users do, for the rows of the table of causes.

    spoil_recording.py RIG.toml FACTOR|invert|opengl|yup    translations in another unit, or extrinsics of another convention
    spoil_recording.py CAMERA black|small|background        silhouettes without anybody, or pictures of half the size
"""

import os
import re
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


if __name__ == "__main__":
    (spoil_rig if sys.argv[1].endswith(".toml") else spoil_pictures)(sys.argv[1], sys.argv[2])
