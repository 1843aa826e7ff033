#!/usr/bin/env python3
"""Renews the tables of docs/measurements/calibration.md from the results of fault_trials.sh.

usage: fault_tables.py WANDS BOARDS TIMES PAGE
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows


def put_faults(results, page, name):
    rows, comment = read_rows(results)
    out = ["| fault | runs | refused | named rightly |", "|---|---|---|---|"]
    for row in rows:
        named = "" if row["fault"].endswith("none") else row["named"]
        out.append(f"| {row['fault']} | {row['runs']} | {row['refused']} | {named} |")
    put_table(page, name, out, comment)


def main(wands, boards, times, page):
    put_faults(wands, page, "wand-trials")
    put_faults(boards, page, "board-trials")
    rows, comment = read_rows(times)
    out = ["| cameras | instants | time | held out | centres | wand's length | by the true cameras |",
           "|---|---|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['cameras']} | {row['instants']} | {row['seconds']} s | {row['held out px']} px | {row['centres mm']} mm | "
                   f"{row['wand length mm']} mm | {row['by the true cameras mm']} mm |")
    put_table(page, "wand-times", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
