#!/usr/bin/env python3
"""Renews the tables of docs/measurements/streams.md from the results of stream_scale.sh, and draws stream_scale.svg.

usage: stream_scale.py SCALE CROWD PAGE FOLDER    the tables go between <!-- scale --> and <!-- crowd --> and their ends
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import read_rows, renew
from svg import BLUE, GREY, VERMILION, Axes, Drawing

RATE_HZ = 30.0  # of the sites
NAMES = {"loopback": "`loopback`", "again": "`loopback`, again", "decode": "`loopback`, decoding", "multicast": "`loopback`, data by multicast",
         "lan": "`lan`", "lan-multicast": "`lan`, data by multicast"}
LINES = {"loopback": ("received and paired", BLUE, None), "decode": ("and decoded", VERMILION, None)}
WIDTH, LEFT, BOX_WIDTH, BOX_HEIGHT = 900, 70, 330, 190


def number(row, key):
    return float(row[key])


def share(value):
    return f"{100 * value:.2f}".rstrip("0").rstrip(".") + " %"


def all_programs(row):
    sites = number(row, "sites") * number(row, "site_percent")
    return sites if row["subscribers"] == "0" else sites + number(row, "subscribers") * number(row, "subscriber_percent")


def mark(row):
    """Marks rows during which other programs used more than a tenth of a core."""
    return " *" if number(row, "host_percent") - all_programs(row) > 10 else ""


def scale_table(rows, comment):
    out = ["| network | subscribers | site | subscriber | all | frames/s of a site | frames complete | decoded | age p50, p99, largest [ms] "
           "| per frame: datagrams, kB |",
           "|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        none = row["subscribers"] == "0"
        decoded = share(number(row, "decoded_share")) if row["decode"] == "true" else ""
        out.append(f"| {NAMES[row['case']]} | {row['subscribers']}{mark(row)} | {number(row, 'site_percent'):.1f} % | "
                   + ("" if none else f"{number(row, 'subscriber_percent'):.1f} %")
                   + f" | {all_programs(row):.0f} % | {number(row, 'published_per_s'):.1f} | "
                   + ("" if none else share(number(row, "share"))) + f" | {decoded} | "
                   + ("" if none else f"{number(row, 'p50_ms'):.1f}, {number(row, 'p99_ms'):.1f}, {number(row, 'max_ms'):.0f}")
                   + f" | {number(row, 'datagrams_per_frame'):.0f}, {number(row, 'kb_per_frame'):.0f} |")
    lengths = sorted({round(number(row, "seconds")) for row in rows})
    beside = " *: other programs used the processor as well." if any(mark(row) for row in rows) else ""
    return "\n".join(out + ["", f"{comment}; {' or '.join(str(n) for n in lengths)} s each.{beside}"])


def crowd_table(rows, comment):
    out = ["| programs | processor, each | all | started in [s] | then all know all [s] | processor time until then [s] | datagrams/s "
           "| kB/s | MB each |", "|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['count']} | {number(row, 'percent_each'):.2f} % | {number(row, 'percent_all'):.0f} % | "
                   f"{number(row, 'started_s'):.0f} | {number(row, 'then_all_know_s'):.1f} | {row['start_cpu_s']} | "
                   f"{row['datagrams_per_s']} | {row['kb_per_s']} | {row['mb_each']} |")
    return "\n".join(out + ["", comment + "."])


def ticks(high):
    step = next(s for s in (1, 2, 5, 10, 20, 50, 100, 200) if high / s <= 7)
    return [step * i for i in range(int(high / step) + 1)]


def panel(drawing, rows, place, title, key, unit, factor=1.0, from_one=False, high=None):
    most = max(number(row, "subscribers") for row in rows if row["case"] in LINES)
    shown = {case: [(number(row, "subscribers"), factor * number(row, key)) for row in rows
                    if row["case"] == case and not (from_one and row["subscribers"] == "0")] for case in LINES}
    high = high or 1.1 * max(y for points in shown.values() for _, y in points)
    box = (LEFT + place[0] * (BOX_WIDTH + 90), 70 + place[1] * (BOX_HEIGHT + 85), BOX_WIDTH, BOX_HEIGHT)
    axes = Axes(drawing, box, (0, most), (0, high), log=False)
    axes.frame(title, "subscribers", unit, [x for x in (0, 4, 8, 16, 32, 48, 64, 80, 96) if x <= most], ticks(high))
    for case, points in shown.items():
        axes.curve([p for p in points if p[1] <= high], LINES[case][1], 2.0, dash=LINES[case][2])


def draw(rows, folder):
    drawing = Drawing(WIDTH, 70 + 2 * (BOX_HEIGHT + 85))
    x = LEFT
    for name, colour, dash in LINES.values():
        drawing.line((x, 25), (x + 30, 25), stroke=colour, width=2.0, dash=dash)
        drawing.text((x + 38, 29), name, 12, fill=GREY)
        x += 70 + 7 * len(name)
    panel(drawing, rows, (0, 0), "A site", "site_percent", "of a core [%]")
    panel(drawing, rows, (1, 0), "A subscriber", "subscriber_percent", "of a core [%]", from_one=True)
    # of the due frames: a site skips frames for which it is too late
    shares = [dict(row, due=number(row, "decoded_share" if row["case"] == "decode" else "share")
                   * number(row, "published_per_s") / RATE_HZ) for row in rows]
    panel(drawing, shares, (0, 1), "Frames complete, or decoded, of those due", "due", "[%]", 100.0, True, 105.0)
    panel(drawing, rows, (1, 1), "Age when complete, 99 % are younger", "p99_ms", "[ms]", from_one=True)
    drawing.write(os.path.join(folder, "stream_scale.svg"))


def main(scale, crowd, page, folder):
    rows, comment = read_rows(scale)
    # the last row of a case that was measured again
    rows = list({(row["case"], row["subscribers"]): row for row in rows}.values())
    if rows:
        renew(page, "scale", scale_table(rows, comment))
        draw(rows, folder)
    rows, comment = read_rows(crowd)
    if rows:
        renew(page, "crowd", crowd_table(rows, comment))


if __name__ == "__main__":
    main(*sys.argv[1:])
