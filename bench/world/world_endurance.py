#!/usr/bin/env python3
"""Renews the table of docs/measurements/world.md from the results of world_endurance.sh.

usage: world_endurance.py TABLE PAGE    the table goes between <!-- world-endurance --> and <!-- /world-endurance -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import read_rows, renew

COLUMNS = [("minutes", "min", "{:.1f}"), ("touched", "ticks with a touch", "{:.0%}"), ("rigid_mps", "fastest object [m/s]", "{:.1f}"),
           ("soft_mps", "fastest soft node [m/s]", "{:.1f}"), ("rigid_specific", "of what a hit and a fall can give", "{:.0%}"),
           ("soft_specific", "soft things", "{:.0%}"), ("energy_j", "most energy [J]", "{:.0f}"), ("energy_bound_j", "bound [J]", "{:.0f}"),
           ("lowest_m", "lowest [m]", "{:.2f}"), ("untouched_gain_j", "most gained in an untouched tick [J]", "{:.3f}"),
           ("not_finite", "not a number", "{:.0f}"), ("runaways", "runaways", "{:.0f}"), ("torn", "torn", "{:.0f}"),
           ("left", "left the world", "{:.0f}"), ("led_out", "led out of people", "{:.0f}")]


def table(rows, comment):
    out = ["| world | " + " | ".join(name for _, name, _ in COLUMNS) + " | broken |", "|" + "---|" * (2 + len(COLUMNS))]
    for row in rows:
        cells = [row["world"]] + [form.format(float(row[name])) for name, _, form in COLUMNS] + [row["broken"] or "none"]
        out.append("| " + " | ".join(cells) + " |")
    return "\n".join(out + ["", comment + "."])


def main(table_file, page):
    rows, comment = read_rows(table_file)
    text = table(rows, comment)
    print(text)
    renew(page, "world-endurance", text)


if __name__ == "__main__":
    main(*sys.argv[1:])
