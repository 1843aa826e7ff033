#!/usr/bin/env python3
"""Renews the table of docs/measurements/streams.md from the results of stream_starved.sh.

usage: stream_starved.py TABLE PAGE    the table goes between <!-- starved --> and <!-- /starved -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows


def summary(rows):
    captured = sum(int(row["captured"]) for row in rows)
    dropped = sum(int(row["dropped_for_rate"]) for row in rows)
    limit = float(rows[0]["limit_mbit_per_s"])
    cells = [rows[0]["starved"], f"{limit:g} Mbit/s" if limit else "none", rows[0]["network"], f"{len(rows)} x {rows[0]['seconds']} s", f"{dropped} of {captured}",
             str(sum(int(row["levels"]) for row in rows))]
    if limit:
        found = [float(row["found_s"]) for row in rows]
        shares = [float(row["share_of_limit"]) for row in rows]
        cells += [f"{sum(found) / len(found):.1f}, {max(found):.1f}", f"{100 * min(shares):.0f} to {100 * max(shares):.0f} %"]
    else:
        at_best = sum(row["last_level"] == "best" for row in rows)
        cells += ["", f"at its best in {at_best} of {len(rows)}"]
    pictures = [float(row["pictures_per_s"]) for row in rows if row["pictures_per_s"]]
    cells.append(f"{min(pictures):.0f} to {max(pictures):.0f}" if pictures else "")
    return "| " + " | ".join(cells) + " |"


def main(table, page):
    rows, comment = read_rows(table)
    cases = {}
    for row in rows:
        cases.setdefault((row["starved"], row["limit_mbit_per_s"], row["network"]), []).append(row)
    out = ["| viewer | limit | network | runs | metaframes left out for the rate | steps | found after, mean and longest [s] | of the limit in use, from 3 s after it | pictures/s |",
           "|---|---|---|---|---|---|---|---|---|"]
    out += [summary(case) for case in cases.values()]
    put_table(page, "starved", out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
