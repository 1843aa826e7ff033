#!/usr/bin/env python3
"""Renews the tables of docs/measurements/viewer.md from the results of texture_quality.sh.

usage: texture_quality.py TABLE PAGE    the tables go between <!-- texture-quality --> and <!-- /texture-quality -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows

SCENES = {"ring20": "ring20: 10 cameras give textures, shown where the other 10 stood",
          "room": "simulated room: 8 cameras, shown at 20 free viewpoints",
          "ring20 own": "ring20, at the poses of the cameras that gave the textures",
          "room own": "simulated room, likewise",
          "ring20 own half": "ring20, likewise, at the textures' resolution",
          "room own half": "simulated room, likewise",
          "ring20 full": "ring20 with textures at full resolution, where the other 10 stood",
          "room full": "simulated room likewise, at 20 free viewpoints",
          "ring20 full own": "ring20 with textures at full resolution, at the poses of the cameras that gave them",
          "room full own": "simulated room, likewise",
          "ring20 round": "ring20 with `hull.refine = \"round\"`, where the other 10 stood",
          "ring20 own round": "likewise, at the poses of the cameras that gave the textures",
          "room round": "simulated room with `hull.refine = \"round\"`, at 20 free viewpoints",
          "room own round": "likewise, at the poses of the cameras that gave the textures",
          "ring20 photo": "ring20 with `hull.refine = \"photo\"`, where the other 10 stood",
          "ring20 own photo": "likewise, at the poses of the cameras that gave the textures",
          "room photo": "simulated room with `hull.refine = \"photo\"`, at 20 free viewpoints",
          "room own photo": "likewise, at the poses of the cameras that gave the textures",
          "ring20 round_photo": "ring20 with `hull.refine = \"round_photo\"`, where the other 10 stood",
          "ring20 own round_photo": "likewise, at the poses of the cameras that gave the textures",
          "room round_photo": "simulated room with `hull.refine = \"round_photo\"`, at 20 free viewpoints",
          "room own round_photo": "likewise, at the poses of the cameras that gave the textures",
          "ring20 hard": "ring20 with `view.outlines = \"hull\"`, where the other 10 stood",
          "ring20 own hard": "likewise, at the poses of the cameras that gave the textures",
          "room hard": "simulated room with `view.outlines = \"hull\"`, at 20 free viewpoints",
          "room own hard": "likewise, at the poses of the cameras that gave the textures",
          "screen": "simulated person before a green screen: 8 cameras, shown at 20 free viewpoints",
          "screen full": "likewise with textures at full resolution"}
WAYS = {"viewer": "viewer", "nearest camera": "nearest camera alone", "equal": "all that face it, equally", "its texture": "the texture itself"}


def mean(rows, column):
    return sum(float(row[column]) for row in rows) / len(rows)


def quality(rows):
    """Mean PSNR, mean PSNR of the inside, and mean SSIM of one scene and method."""
    if not rows:
        return ""
    return f"{mean(rows, 'psnr_db'):.1f} ({mean(rows, 'inner_psnr_db'):.1f}) dB, {mean(rows, 'ssim'):.3f}"


def main(table, page):
    rows, comment = read_rows(table)
    out = ["| shown | " + " | ".join(WAYS.values()) + " | not covered | beyond |", "|---" * (3 + len(WAYS)) + "|"]
    for scene, what in SCENES.items():
        own = [row for row in rows if row["scene"] == scene]
        if not own:
            continue
        by_way = {way: [row for row in own if row["way"] == way] for way in WAYS}
        cells = [quality(by_way[way]) for way in WAYS]
        shares = [f"{100 * mean(by_way['viewer'], column):.1f} %" for column in ("bare", "beyond")]
        out.append(f"| {what} | " + " | ".join(cells + shares) + " |")
    orbit = {row["way"]: row for row in rows if row["scene"] == "orbit"}
    if orbit:
        shown, true = orbit["viewer"], orbit["truth"]
        # columns of orbits: largest change of a picture, of a block, and the mean change
        out += ["", "| around the simulated person in 360 steps: change from picture to picture, grey levels | viewer | true surface | ratio |",
                "|---|---|---|---|"]
        for column, what in {"psnr_db": "largest, mean over the picture", "inner_psnr_db": "largest, mean over a block of 16 x 16 pixels",
                             "ssim": "mean of all"}.items():
            a, b = float(shown[column]), float(true[column])
            out.append(f"| {what} | {a:.2f} | {b:.2f} | {a / b:.2f} |")
    put_table(page, "texture-quality", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
