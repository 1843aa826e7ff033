#!/usr/bin/env python3
"""Writes a rig of three cameras and the points of five lights on its floor, for the rows of calibrate_board.toml.

    make_floor.py RIG.toml POINTS.csv [--swap] [--moved]

--swap: lights 1 and 2 have each other's numbers. --moved: the last camera sees all lights 60 px beside their places.
"""

import argparse
import math

WIDTH, HEIGHT, FOCAL = 1280, 1024, 1000
LIGHTS = [(0, 0), (0.8, 0), (0.1, 0.6), (-0.5, -0.4), (0.6, -0.5)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("rig")
    parser.add_argument("points")
    parser.add_argument("--swap", action="store_true")
    parser.add_argument("--moved", action="store_true")
    options = parser.parse_args()
    rig, rows = ['units = "m"', "rate_hz = 30.0"], ["camera,instant,light,x_px,y_px"]
    for i in range(3):
        angle = 2 * math.pi * i / 3
        centre = [3 * math.cos(angle), 3 * math.sin(angle), 2.2]
        z = unit([-c for c in centre[:2]] + [-centre[2]])
        x = unit(cross(z, [0, 0, 1]))
        rotation = (x, cross(z, x), z)
        rig += ["", "[[camera]]", f'name = "cam{i}"', f"width = {WIDTH}", f"height = {HEIGHT}", f"fx = {FOCAL}.0", f"fy = {FOCAL}.0",
                f"cx = {(WIDTH - 1) / 2}", f"cy = {(HEIGHT - 1) / 2}", f"rotation = {[v for row in rotation for v in row]}",
                f"translation = {[-dot(row, centre) for row in rotation]}"]
        for light, place in enumerate(LIGHTS):
            p = [dot(row, [place[0] - centre[0], place[1] - centre[1], -centre[2]]) for row in rotation]
            u = (WIDTH - 1) / 2 + FOCAL * p[0] / p[2] + (60 if options.moved and i == 2 else 0)
            v = (HEIGHT - 1) / 2 + FOCAL * p[1] / p[2]
            number = {1: 2, 2: 1}.get(light, light) if options.swap else light
            rows.append(f"cam{i},0,{number},{u:.3f},{v:.3f}")
    for file, lines in ((options.rig, rig), (options.points, rows)):
        with open(file, "w") as stream:
            stream.write("\n".join(lines) + "\n")


main()
