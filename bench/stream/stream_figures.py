#!/usr/bin/env python3
"""Draws docs/figures/stream_adaptation.svg from the output of `stream_link`.

usage: stream_link | stream_figures.py FOLDER
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from svg import BLUE, GREY, ORANGE, SKY, VERMILION, Axes, Drawing

WIDTH = 860
LEFT, BOX_WIDTH = 70, 690


def read(stream):
    rows, steps = [], []
    for line in stream:
        words = line.split()
        if words[0] == "step":
            steps.append([float(word) for word in words[1:]])
        else:
            rows.append([float(word) for word in words])
    return rows, steps


def label(axes, at, text, colour):
    axes.drawing.text((LEFT + BOX_WIDTH + 8, axes.at(*at)[1] + 4), text, 12, fill=colour)


def stairs(points, end):
    out = []
    for i, (x, y) in enumerate(points):
        out += [(x, y), (points[i + 1][0] if i + 1 < len(points) else end, y)]
    return out


def main():
    rows, steps = read(sys.stdin)
    end = rows[-1][0]
    drawing = Drawing(WIDTH, 715)

    rates = Axes(drawing, (LEFT, 40, BOX_WIDTH, 230), (0, end), (0, 55), log=False)
    rates.frame("Rate", "time [s]", "[Mbit/s]", range(0, int(end) + 1, 10), range(0, 51, 10))
    link = [(row[0], row[1]) for row in rows]
    rates.curve(stairs(link, end), GREY, 1.5, dash="5 3", dots=False)
    rates.curve([(row[0], row[2]) for row in rows], SKY, 1.5, dots=False)
    rates.curve([(row[0] + 0.25, row[3]) for row in rows], BLUE, 2.0, dots=False)
    label(rates, (end, 50), "the link", GREY)
    label(rates, (end, rows[-1][2] + 3), "wanted", SKY)
    label(rates, (end, rows[-1][3] - 3), "carried", BLUE)

    ages = Axes(drawing, (LEFT, 340, BOX_WIDTH, 140), (0, end), (0, 350), log=False)
    ages.frame("Age on arrival", "time [s]", "[ms]", range(0, int(end) + 1, 10), range(0, 351, 100))
    arrived = [row for row in rows if row[4] < 1e6]
    ages.curve([(row[0] + 0.25, row[4]) for row in arrived], ORANGE, 1.0, dots=False)
    ages.curve([(row[0] + 0.25, row[5]) for row in arrived], VERMILION, 2.0, dots=False)
    label(ages, (end, 130), "largest", ORANGE)
    label(ages, (end, 40), "median", VERMILION)

    # the levels by name, best on top
    names = sorted({(85, 1, 1)} | {tuple(int(w) for w in step[1:]) for step in steps}, key=lambda s: (s[2], s[1], -s[0]))
    place = {name: len(names) - i for i, name in enumerate(names)}
    levels = Axes(drawing, (LEFT + 70, 550, BOX_WIDTH - 70, 110), (0, end), (0.5, len(names) + 0.5), log=False)
    levels.frame("Level: quality, resolution, rate", "time [s]", "", range(0, int(end) + 1, 10), [])
    for name, y in place.items():
        drawing.text((LEFT + 64, levels.at(0, y)[1] + 3), f"{name[0]}  1/{name[1]}  1/{name[2]}", 8.5, "end", GREY)
    points = [(0.0, place[(85, 1, 1)])] + [(step[0], place[tuple(int(w) for w in step[1:])]) for step in steps]
    levels.curve(stairs(points, end), BLUE, 2.0, dots=False)
    drawing.write(os.path.join(sys.argv[1], "stream_adaptation.svg"))


if __name__ == "__main__":
    main()
