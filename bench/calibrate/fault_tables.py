#!/usr/bin/env python3
"""Renews the tables of docs/measurements/calibration.md from the results of fault_trials.sh.

usage: fault_tables.py WANDS BOARDS WIDTHS TIMES PAGE
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


def put_widths(results, page):
    rows, comment = read_rows(results)
    jitters = sorted({row["jitter"] for row in rows}, key=float)
    widths = sorted({row["robust sigmas"] for row in rows}, key=float)
    centres = {(row["jitter"], row["robust sigmas"]): row["centres mm"] for row in rows}
    out = ["| pictures early or late, up to | " + " | ".join(f"{width} sigmas" for width in widths) + " |", "|---" * (len(widths) + 1) + "|"]
    for jitter in jitters:
        said = "none: a trigger" if float(jitter) == 0 else f"{jitter} instants"
        out.append(f"| {said} | " + " | ".join(f"{centres[jitter, width]} mm" for width in widths) + " |")
    put_table(page, "board-widths", out, comment)


def main(wands, boards, widths, times, page):
    put_faults(wands, page, "wand-trials")
    put_faults(boards, page, "board-trials")
    put_widths(widths, page)
    rows, comment = read_rows(times)
    out = ["| cameras | instants | time | held out | centres | wand's length | by the true cameras |",
           "|---|---|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['cameras']} | {row['instants']} | {row['seconds']} s | {row['held out px']} px | {row['centres mm']} mm | "
                   f"{row['wand length mm']} mm | {row['by the true cameras mm']} mm |")
    put_table(page, "wand-times", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
