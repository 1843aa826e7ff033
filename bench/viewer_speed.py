#!/usr/bin/env python3
"""Renews the table of docs/viewer.md from what viewer_speed.sh keeps.

usage: viewer_speed.py TABLE PAGE    the table goes between <!-- viewer-speed --> and <!-- /viewer-speed -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_table import read_rows, renew


def main(table_file, page):
    rows, comment = read_rows(table_file)
    out = ["| what | picture | pictures/s | at least | taking in new people, median and p99 [ms] | capture to display, median and p99 [ms] |",
           "|---|---|---|---|---|---|"]
    for row in rows:
        met = "met" if float(row["frames_per_s"]) >= float(row["allowed_fps"]) else "missed"
        out.append(f"| {row['case']} | {row['width']}x{row['height']} | **{row['frames_per_s']}**: {met} | {row['allowed_fps']} "
                   f"| {row['taking_in_ms']}, {row['taking_in_p99_ms']} | {row['capture_to_display_ms']}, {row['p99_ms']} |")
    out += ["", comment + "."]
    text = "\n".join(out)
    print(text)
    renew(page, "viewer-speed", text)


if __name__ == "__main__":
    main(*sys.argv[1:])
