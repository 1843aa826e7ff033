#!/usr/bin/env python3
"""Renews the table of docs/measurements/streams.md from the results of stream_faults.sh.

usage: stream_faults.py TABLE PAGE    the table goes between <!-- faults --> and <!-- /faults -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows


def main(table, page):
    rows, comment = read_rows(table)
    out = ["| fault | frames complete | age p50, p99, largest [ms] | kB/s | back after [ms] | site, before and after [MB] | out of order |",
           "|---|---|---|---|---|---|---|"]
    for row in rows:
        back = "" if row["recovery_ms"] == "nan" else row["recovery_ms"]
        out.append(f"| {row['case']} | {row['complete']} of {row['published']}, {float(row['share']):.1f} % | {row['p50_ms']}, "
                   f"{row['p99_ms']}, {row['max_ms']} | {row['kb_per_s']} | {back} | {row['before_mb']}, {row['after_mb']} | "
                   f"{row['out_of_order']} |")
    put_table(page, "faults", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
