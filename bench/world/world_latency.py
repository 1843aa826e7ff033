#!/usr/bin/env python3
"""Renews the table of docs/measurements/world.md from the results of world_latency.sh.

usage: world_latency.py TABLE PAGE    the table goes between <!-- world-latency --> and <!-- /world-latency -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows


def main(table_file, page):
    rows, comment = read_rows(table_file)
    out = ["| sites | pictures/s | pushes, missed | median, p90, p99 [ms] | allowed | within the bar | capture to mesh | mesh to tick | tick to state | from the touch itself |",
           "|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        met = "met" if float(row["median_ms"]) <= float(row["bar_ms"]) else "missed"
        out.append(f"| {row['case']} | {float(row['rate_hz']):.0f} | {row['pushes']}, {row['missed']} | **{row['median_ms']}**, {row['p90_ms']}, {row['p99_ms']}: {met} | {row['bar_ms']} "
                   f"| {100.0 * float(row['share_within']):.0f} % | {row['site_ms']} | {row['world_ms']} | {row['send_ms']} | {row['touch_ms']} |")
    put_table(page, "world-latency", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
