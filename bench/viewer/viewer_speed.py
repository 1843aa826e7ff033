#!/usr/bin/env python3
"""Renews the tables of docs/measurements/viewer.md from the results of viewer_speed.sh.

usage: viewer_speed.py SPEED GUESTS PAGE    the tables go between <!-- viewer-speed --> and <!-- /viewer-speed -->, <!-- viewer-guests --> and its end
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import read_rows, renew


def speed(rows, comment):
    out = ["| what | triangles | picture | pictures/s | at least | taking in a new person, median and p99 [ms] | capture to display, median and p99 [ms] |",
           "|---|---|---|---|---|---|---|"]
    for row in rows:
        met = "met" if float(row["frames_per_s"]) >= float(row["allowed_fps"]) else "missed"
        triangles = " and ".join(f"{int(n):,}" for n in row["triangles"].split())
        out.append(f"| {row['case']} | {triangles} | {row['width']}x{row['height']} | **{row['frames_per_s']}**: {met} | {row['allowed_fps']} "
                   f"| {row['taking_in_ms']}, {row['taking_in_p99_ms']} | {row['capture_to_display_ms']}, {row['p99_ms']} |")
    return "\n".join(out + ["", comment + "."])


def guests(rows, comment):
    out = ["| who comes to a person of 8 cameras | pictures/s of 30 | a picture, median [ms] | longest before it is drawn [ms] | longest in all [ms] | refused |",
           "|---|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['guest']} | {row['frames_per_s']} | {row['picture_ms']} | {row['longest_preparation_ms']} | {row['longest_picture_ms']} "
                   f"| {row['rejected']} |")
    return "\n".join(out + ["", comment + ", 640x360."])


def main(speed_file, guests_file, page):
    for name, file, table in (("viewer-speed", speed_file, speed), ("viewer-guests", guests_file, guests)):
        rows, comment = read_rows(file)
        text = table(rows, comment)
        print(text, end="\n\n")
        renew(page, name, text)


if __name__ == "__main__":
    main(*sys.argv[1:])
