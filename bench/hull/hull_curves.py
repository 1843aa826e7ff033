#!/usr/bin/env python3
"""Draws docs/figures/hull_curves.svg from the tables of hull_curves.sh, prints them, and renews those of docs/measurements/hull.md.

usage: hull_curves.py PREFIX PICTURE PAGE    reads PREFIX-segments.csv and so on; tables go between <!-- name --> and <!-- /name -->
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import read_numbers, renew, table
from svg import (BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, Axes, Drawing, ticks_log)

STAGES = [("total_ms", "total", BLACK, 2.5), ("sweep_ms", "sweep", BLUE, 2.0),
          ("pencils_ms", "pencils", VERMILION, 2.0), ("assembly_ms", "assembly", GREEN, 2.0),
          ("silhouettes_ms", "silhouettes", PURPLE, 2.0)]


def exponent(points):
    """Slope of the straight line through the logarithms, by least squares."""
    xs = [math.log(x) for x, _ in points]
    ys = [math.log(y) for _, y in points]
    mx, my = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)


def times_of(rows, key, column):
    return [(row[key], row[column]) for row in rows]


def stages(axes, rows, key):
    labels = []
    for column, name, colour, width in STAGES:
        points = times_of(rows, key, column)
        axes.curve(points, colour, width)
        labels.append((axes.at(*points[-1]), name, colour))
    lowest = -1e9
    for (x, y), name, colour in sorted(labels, key=lambda label: label[0][1]):
        lowest = max(y, lowest + 14)  # labels must not overlap
        axes.drawing.text((x + 8, lowest + 4), name, 11, fill=colour)


def guide(axes, rows, key, law, label):
    """A dashed line that follows `law` through the last total."""
    xs = [row[key] for row in rows]
    scale = rows[-1]["total_ms"] / law(xs[-1])
    points = [(x, 1.6 * scale * law(x)) for x in xs if 1.6 * scale * law(x) >= axes.y_range[0]]
    axes.curve(points, GREY, 1.2, "5 4", dots=False)
    x, y = axes.at(*points[-2])
    axes.drawing.text((x - 8, y - 6), label, 11, "end", GREY)


def draw(prefix, picture):
    by_segments, comment = read_numbers(f"{prefix}-segments.csv")
    by_views, _ = read_numbers(f"{prefix}-views.csv")
    by_threads, _ = read_numbers(f"{prefix}-threads.csv")
    d = Drawing(1180, 430)
    a = Axes(d, (60, 40, 330, 310), (18, 1250), (0.02, 100))
    a.frame("(a) 8 views", "segments per view", "milliseconds", [20, 50, 100, 200, 500, 1000],
            ticks_log(0.02, 100))
    stages(a, by_segments, "segments_per_view")
    guide(a, by_segments, "segments_per_view", lambda n: n * math.log(n), "n log n")
    b = Axes(d, (525, 40, 290, 310), (3.6, 70), (0.1, 3000))
    b.frame("(b) 250 segments per view", "views", "milliseconds", [4, 8, 16, 32, 64], ticks_log(0.1, 3000))
    stages(b, by_views, "num_views")
    guide(b, by_views, "num_views", lambda n: n ** 2.5, "n^2.5")
    threads(d, by_threads)
    d.text((60, 420), comment, 10, fill=GREY)
    d.write(picture)


def threads(d, rows):
    most = max(row["threads"] for row in rows)
    high = max(2.0, most)
    c = Axes(d, (960, 40, 190, 310), (0.8, high + 0.2), (0.0, high + 0.2), log=False)
    ticks = range(1, int(high) + 1)
    c.frame("(c) threads", "threads", "speed-up", ticks, [0, 0.5, 1, 1.5, 2] if high < 3 else range(0, int(high) + 1))
    c.curve([(1, 1), (most, most)], GREY, 1.2, "5 4", dots=False)
    place = c.at(0.85 * most, 0.85 * most)
    d.text((place[0] - 8, place[1] - 6), "ideal", 11, "end", GREY)
    for i, (scene, colour) in enumerate((("person_8", BLUE), ("person_24", ORANGE))):
        of_scene = [row for row in rows if row["scene"] == scene]
        for column, dash, name in (("total_ms", None, "total"), ("sweep_ms", "3 3", "sweep")):
            points = [(row["threads"], of_scene[0][column] / row[column]) for row in of_scene]
            c.curve(points, colour, 2.0, dash)
            y = 300 + 15 * (2 * i + (column == "sweep_ms"))
            d.line((975, y - 4), (1000, y - 4), stroke=colour, width=2.0, dash=dash)
            d.text((1006, y), f"{scene.split('_')[1]} views, {name}", 11)


def pairs(rows, key):
    """Rows of one and of two threads side by side."""
    out = {}
    for row in rows:
        out.setdefault((row[key], row["views"]), {})[int(row["threads"])] = row
    return out.values()


def ms(value):
    return f"{value:.0f}" if value >= 99.5 else f"{value:.1f}"


def print_tables(prefix, page):
    for name, key in (("segments", "segments_per_view"), ("views", "num_views")):
        rows, comment = read_numbers(f"{prefix}-{name}.csv")
        table(f"{name} ({comment})", [key, "segments", "triangles"] + [s[1] for s in STAGES],
              [[f"{row[key]:.0f}", f"{row['segments']:.0f}", f"{row['triangles']:.0f}"]
               + [f"{row[s[0]]:.2f}" for s in STAGES] for row in rows])
        upper = rows[len(rows) // 3:]
        powers = {s[1]: exponent(times_of(upper, key, s[0])) for s in STAGES}
        print(f"\nexponents over the upper two thirds: " + ", ".join(f"{n} {p:.2f}" for n, p in powers.items()))
        if name == "segments":
            nlogn = [(row[key], row["total_ms"] / (row[key] * math.log2(row[key]))) for row in upper]
            print("total / (n log2 n) [us]: " + ", ".join(f"{1e3 * y:.2f}" for _, y in nlogn)
                  + f"; exponent of what is left: {exponent(nlogn):.2f}")
    rows, comment = read_numbers(f"{prefix}-sets.csv")
    text = table("sets", ["set", "views", "segments", "triangles", "1 thread [ms]", "2 threads [ms]"],
                 [[p[1]["set"], f"{p[1]['views']:.0f}", f"{p[1]['segments']:.0f}", f"{p[1]['triangles']:.0f}",
                   ms(p[1]["total_ms"]), ms(p[2]["total_ms"])] for p in pairs(rows, "set")])
    if rows:
        renew(page, "sets", f"{comment}:\n\n{text}")
    rows, comment = read_numbers(f"{prefix}-masks.csv")
    text = table("masks", ["recording", "cameras", "segments", "triangles", "volume [l]", "coverage mean; worst [%]",
                           "excess [px]", "1 thread [ms]", "2 threads [ms]"],
                 [[p[1]["recording"], f"{p[1]['views']:.0f}", f"{p[1]['segments']:.0f}", f"{p[1]['triangles']:.0f}",
                   f"{p[1]['volume_l']:.1f}",
                   f"{p[1]['coverage_mean_percent']:.1f}; {p[1]['coverage_worst_percent']:.1f}",
                   f"{p[1]['excess_px']:.0f}", ms(p[1]["total_ms"]), ms(p[2]["total_ms"])]
                  for p in pairs(rows, "recording")])
    if rows:
        renew(page, "masks", f"{comment}:\n\n{text}")
    rows, comment = read_numbers(f"{prefix}-memory.csv")
    text = table("memory", ["scene", "views", "segments", "triangles", "scratch [MB]", "with 2 threads [MB]", "mesh [MB]"],
                 [[p[1]["scene"], f"{p[1]['views']:.0f}", f"{p[1]['segments']:.0f}", f"{p[1]['triangles']:.0f}",
                   f"{p[1]['scratch_mb']:.1f}", f"{p[2]['scratch_mb']:.1f}", f"{p[1]['mesh_mb']:.1f}"]
                  for p in pairs(rows, "scene")])
    renew(page, "memory", comment.split(", least")[0] + f":\n\n{text}")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    draw(sys.argv[1], sys.argv[2])
    print_tables(sys.argv[1], sys.argv[3])
