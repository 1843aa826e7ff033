#!/usr/bin/env python3
"""Renews the table of docs/measurements/world.md and its curves from the results of world_step.sh.

usage: world_step.py TABLE PAGE SVG    the table goes between <!-- world-step --> and <!-- /world-step -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import svg
from page_table import read_rows, renew

SWEEPS = [("bodies", "rigid bodies", "Bodies"), ("people", "people", "People"), ("triangles", "triangles of a person", "Triangles")]
BARS = [("median_ms", "median", 4.0), ("p99_ms", "p99", 8.0), ("take_max_ms", "taking in a mesh, longest", 1.0)]
COLUMNS = [("median_ms", "step, median [ms]", "{:.2f}"), ("p99_ms", "p99", "{:.2f}"), ("take_median_ms", "taking in a mesh [ms]", "{:.3f}"),
           ("take_max_ms", "longest", "{:.3f}"), ("shape_ms", "preparing it beside the step [ms]", "{:.1f}"),
           ("touched", "ticks in which people touch things", "{:.0%}"), ("soft_touched", "and soft things", "{:.0%}"),
           ("moving", "objects that move", "{:.0f}")]


def table(rows, comment):
    out = ["| bodies | people | triangles | soft | " + " | ".join(name for _, name, _ in COLUMNS) + " |", "|" + "---|" * (4 + len(COLUMNS))]
    seen = set()
    for row in rows:
        key = (row["bodies"], row["people"], row["triangles"], row["soft"])
        if key in seen:
            continue
        seen.add(key)
        cells = list(key) + [form.format(float(row[name])) for name, _, form in COLUMNS]
        out.append("| " + " | ".join(cells) + " |")
    first = rows[0]
    bars = ", ".join("{} {:.2g} of {:g} ms: {}".format(name, float(first[column]), most, "met" if float(first[column]) <= most else "missed")
                     for column, name, most in BARS)
    return "\n".join(out + ["", f"The first row against its bars: {bars}. {comment}.", "",
                             "![Times of a step against bodies, people and triangles](../figures/world_step.svg)"])


def curves(rows, path):
    width, height = 300, 190
    drawing = svg.Drawing(3 * (width + 75) + 10, height + 105)
    top = max(float(row["p99_ms"]) for row in rows) * 1.15
    for i, (sweep, label, title) in enumerate(SWEEPS):
        own = [row for row in rows if row["sweep"] == sweep]
        if not own:
            continue
        xs = [float(row[sweep]) for row in own]
        axes = svg.Axes(drawing, (60 + i * (width + 75), 35, width, height), (0, max(xs)), (0, top), log=False)
        axes.frame(title, label, "ms", xs[::2] if len(xs) > 5 else xs, [round(top * k / 4, 1) for k in range(5)])
        axes.curve([(x, float(row["median_ms"])) for x, row in zip(xs, own)], svg.BLUE)
        axes.curve([(x, float(row["p99_ms"])) for x, row in zip(xs, own)], svg.VERMILION)
        axes.curve([(x, float(row["shape_ms"])) for x, row in zip(xs, own) if float(row["shape_ms"]) <= top], svg.GREY, dash="4 3")
    y = height + 90
    for x, colour, name in ((60, svg.BLUE, "step, median"), (180, svg.VERMILION, "step, 99th percentile"),
                            (350, svg.GREY, "preparing a mesh, beside the step")):
        drawing.line((x, y - 4), (x + 22, y - 4), stroke=colour, width=2)
        drawing.text((x + 28, y), name, 12)
    drawing.write(path)


def main(table_file, page, figure):
    rows, comment = read_rows(table_file)
    text = table(rows, comment)
    print(text)
    curves(rows, figure)
    renew(page, "world-step", text)


if __name__ == "__main__":
    main(*sys.argv[1:])
