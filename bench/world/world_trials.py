#!/usr/bin/env python3
"""Renews the table of docs/measurements/world.md from the results of world_trials.sh.

usage: world_trials.py TABLE PAGE    the table goes between <!-- world-trials --> and <!-- /world-trials -->
"""

import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows

WHAT = {"palm": "carried on a palm", "tray": "carried on a tray", "clasp": "held between two palms, moved 1 m, turned by 90 degrees",
        "level": "the same with the palms at its right and left", "handover": "handed from the person of one site to that of another",
        "throw": "a ball thrown forwards from between the palms", "kick": "a ball on the floor kicked at 2 to 5 m/s"}


def share(rows):
    return f"{sum(row['succeeded'] == '1' for row in rows)} of {len(rows)}"


def reasons(rows):
    """What went wrong, most frequent first; numbers left out."""
    found = {}
    for row in rows:
        if row["succeeded"] == "0":
            text = re.split(r"[,(]| at [0-9]|\d", row["reason"])[0].strip() or "speed"
            found[text] = found.get(text, 0) + 1
    return ", ".join(f"{text} ({n})" for text, n in sorted(found.items(), key=lambda item: -item[1]))


def main(table, page):
    rows, comment = read_rows(table)
    by_name = {}
    for row in rows:
        by_name.setdefault(row["trial"], []).append(row)
    out = ["| trial | ball | box | what failed |", "|---|---|---|---|"]
    for name, what in WHAT.items():
        ball = by_name.get(name, by_name.get(name + "-ball", []))
        box = by_name.get(name + "-box", [])
        if ball or box:
            out.append(f"| {what} | {share(ball) if ball else ''} | {share(box) if box else ''} | {reasons(ball + box)} |")
    strikes = [(int(found[1]), int(found[2]), own) for name, own in by_name.items()
               if (found := re.fullmatch(r"strike-(\d+)mps-(\d+)hz", name))]
    if strikes:
        out += ["", "| a hand hits a ball of 5 cm | " + " | ".join(f"{speed} m/s" for speed in sorted({s for s, _, _ in strikes})) + " |",
                "|---" * (1 + len({s for s, _, _ in strikes})) + "|"]
        for rate in sorted({r for _, r, _ in strikes}):
            cells = []
            for speed, _, own in sorted((s for s in strikes if s[1] == rate), key=lambda s: s[0]):
                ratios = sorted(float(row["measure"]) for row in own)
                hits = sum(ratio >= 0.3 for ratio in ratios)
                cells.append(f"{share(own)}; {hits} hit, {ratios[0]:.2f} to {ratios[-1]:.2f}")
            out.append(f"| meshes at {rate} Hz | " + " | ".join(cells) + " |")
    put_table(page, "world-trials", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
