#!/usr/bin/env python3
"""Renews the tables of docs/measurements/calibration.md from the results of coherence_trials.sh.

usage: coherence_tables.py DRIFT HOUR PAGE
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows


def main(drift, hour, page):
    rows, comment = read_rows(drift)
    out = ["| one camera | runs | named | median | longest |", "|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['fault']} | {row['runs']} | {row['named']} | {row['median s']} s | {row['longest s']} s |")
    put_table(page, "coherence-drift", out, comment)
    rows, comment = read_rows(hour)
    out = ["| people | minutes | instants | alarms | single judgements that blame a camera | largest coherence |", "|---|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['people']} | {row['minutes']} | {row['looks']} | {row['alarms']} | {row['single judgements']} | "
                   f"{row['largest px']} px |")
    put_table(page, "coherence-hour", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
