#!/usr/bin/env python3
"""Renews a table of docs/measurements/calibration.md from the results of refined_texture.sh.

usage: refined_texture.py BEFORE AFTER PAGE
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows

SCENES = {"ring20": "where the other 10 cameras stood",
          "ring20 full": "likewise, textures at full resolution",
          "ring20 full own": "at the poses of the cameras that gave them, at full resolution"}


def cells(rows, scene):
    own = [row for row in rows if row["scene"] == scene and row["way"] == "viewer"]
    psnr, inner, ssim, bare = (sum(float(row[column]) for row in own) / len(own)
                               for column in ["psnr_db", "inner_psnr_db", "ssim", "bare"])
    return f"{psnr:.2f} ({inner:.2f}) dB, {ssim:.3f}, {100 * bare:.1f} %"


def main(before, after, page):
    old, _ = read_rows(before)
    new, comment = read_rows(after)
    out = ["| ring20: 10 cameras give textures, shown | rig as it is: PSNR (of the inside), SSIM, not covered | refined |", "|---|---|---|"]
    for scene, what in SCENES.items():
        out.append(f"| {what} | {cells(old, scene)} | {cells(new, scene)} |")
    put_table(page, "refined-texture", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
