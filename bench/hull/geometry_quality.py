#!/usr/bin/env python3
"""Renews the table of docs/measurements/hull.md from the results of geometry_quality.sh.

usage: geometry_quality.py TABLE PAGE    the table goes between <!-- geometry-quality --> and <!-- /geometry-quality -->
"""

import os
import statistics
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_numbers


def mean(rows, column):
    return sum(row[column] for row in rows) / len(rows)


def main(table, page):
    rows, comment = read_numbers(table)
    lines = ["| person | shape | triangles | body [l] | outside of the body [l] | missing [l] | from the shape to the body: mean, 95 % [mm] "
             "| from the body to the shape [mm] | work, median [ms] |", "|---|---|---|---|---|---|---|---|---|"]
    looks = list(dict.fromkeys(row["look"] for row in rows))
    for look in [*looks, "all"]:
        for shape in dict.fromkeys(row["shape"] for row in rows):
            own = [row for row in rows if row["shape"] == shape and look in (row["look"], "all")]
            lines.append(f"| {look} | {shape} | {mean(own, 'triangles'):,.0f} | {mean(own, 'true_l'):.1f} | {mean(own, 'excess_l'):.2f} | {mean(own, 'missing_l'):.2f} | "
                         f"{mean(own, 'mean_mm'):.1f}, {mean(own, 'p95_mm'):.1f} | "
                         f"{mean(own, 'true_mean_mm'):.1f}, {mean(own, 'true_p95_mm'):.1f} | {statistics.median(row['work_ms'] for row in own):.1f} |")
    num_instants = len({(row["look"], row["motion"], row["time_s"]) for row in rows}) // len(looks)
    put_table(page, "geometry-quality", lines, f"{comment}; means of {num_instants} instants of six motions for each person")


if __name__ == "__main__":
    main(*sys.argv[1:])
