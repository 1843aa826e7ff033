#!/usr/bin/env python3
"""Renews the tables of docs/measurements/hull.md from the results of geometry_steadiness.sh and geometry_people.sh.

usage: geometry_motion.py steadiness|people TABLE PAGE    the table goes between <!-- geometry-steadiness --> or <!-- geometry-people -->
                                                          and its end
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_numbers


def by_shape(rows):
    shapes = {}
    for row in rows:
        shapes.setdefault(row["shape"], []).append(row)
    return shapes.items()


def steadiness(rows):
    lines = ["| shape | change of the distance per metaframe: mean, 95 % [mm] | body inside the shape, mean [mm] | body outside of it, mean [mm] |",
             "|---|---|---|---|"]
    for shape, own in by_shape(rows):
        mean = {column: sum(row[column] for row in own) / len(own) for column in ("mean_mm", "p95_mm", "out_mm", "in_mm")}
        lines.append(f"| {shape} | {mean['mean_mm']:.2f}, {mean['p95_mm']:.2f} | {mean['out_mm']:.2f} | {mean['in_mm']:.2f} |")
    return lines, "means of six motions of each person"


def people(rows):
    lines = ["| shape | metaframes | phantoms | metaframes with a lost limb | farthest that a place of a body is outside of the shape [mm] |",
             "|---|---|---|---|---|"]
    for shape, own in by_shape(rows):
        total = {column: sum(row[column] for row in own) for column in ("metaframes", "phantoms", "lost")}
        lines.append(f"| {shape} | {total['metaframes']:,.0f} | {total['phantoms']:.0f} | {total['lost']:.0f} | "
                     f"{max(row['missing_mm'] for row in own):.0f} |")
    return lines, "two people, six motions"


def main(what, table, page):
    rows, comment = read_numbers(table)
    lines, of = {"steadiness": steadiness, "people": people}[what](rows)
    put_table(page, f"geometry-{what}", lines, f"{comment}; {of}")


if __name__ == "__main__":
    main(*sys.argv[1:])
