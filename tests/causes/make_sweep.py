#!/usr/bin/env python3
"""Writes the points of a wand that is swept before five cameras of 1280x1024 px, for the rows of calibrate_wand.toml.

    make_sweep.py FILE.csv [--lights M,...] [--late CAMERA] [--twin CAMERA] [--few CAMERA]

--lights: places of the lights along the wand [m]. --late: this camera is an instant late. --twin: it has the points of cam0. --few: it sees the
wand in the first 12 instants only.
"""

import argparse
import math
import random

NUM_CAMERAS, NUM_INSTANTS, WIDTH, HEIGHT = 5, 150, 1280, 1024


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def cameras():
    """Name, centre, rows of the rotation into the camera, focal length."""
    for i in range(NUM_CAMERAS):
        angle = 2 * math.pi * i / NUM_CAMERAS
        centre = [3 * math.cos(angle), 3 * math.sin(angle), 2.2]
        z = unit(minus([0, 0, 1], centre))
        x = unit(cross(z, [0, 0, 1]))
        yield f"cam{i}", centre, (x, cross(z, x), z), 1000 + 20 * i


def wand(instant):
    """Place of light 0, and direction."""
    t = instant / 15
    start = [0.9 * math.sin(1.1 * t), 0.9 * math.cos(0.9 * t), 1.1 + 0.6 * math.sin(1.7 * t)]
    return start, unit([math.sin(2 * t), math.cos(1.3 * t), math.sin(0.7 * t)])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--lights", default="0,0.1,0.3,0.6")
    parser.add_argument("--late")
    parser.add_argument("--twin")
    parser.add_argument("--few")
    options = parser.parse_args()
    noise = random.Random(5)
    rows = {}
    for name, centre, rotation, focal in cameras():
        rows[name] = []
        for instant in range(12 if name == options.few else NUM_INSTANTS):
            start, along = wand(instant - (1 if name == options.late else 0))
            for place in map(float, options.lights.split(",")):
                p = [dot(row, minus([s + a * place for s, a in zip(start, along)], centre)) for row in rotation]
                x = (WIDTH - 1) / 2 + focal * p[0] / p[2] + noise.gauss(0, 0.2)
                y = (HEIGHT - 1) / 2 + focal * p[1] / p[2] + noise.gauss(0, 0.2)
                if 0 <= x < WIDTH - 1 and 0 <= y < HEIGHT - 1:
                    rows[name].append(f"{instant},,{x:.3f},{y:.3f}")
    if options.twin:
        rows[options.twin] = rows["cam0"]
    with open(options.file, "w") as stream:
        stream.write("camera,instant,light,x_px,y_px\n")
        for name, lines in rows.items():
            stream.writelines(f"{name},{line}\n" for line in lines)


main()
