#!/usr/bin/env python3
"""Renews the table of docs/streams.md from what stream_faults.sh keeps.

usage: stream_faults.py TABLE PAGE    the table goes between <!-- faults --> and <!-- /faults -->
"""

import csv
import re
import sys


def main(table, page):
    with open(table, encoding="utf-8") as file:
        lines = file.read().splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    out = ["| fault | frames complete | age p50, p99, largest [ms] | kB/s | back after [ms] | site, before and after [MB] | out of order |",
           "|---|---|---|---|---|---|---|"]
    for row in rows:
        back = "" if row["recovery_ms"] == "nan" else row["recovery_ms"]
        out.append(f"| {row['case']} | {row['complete']} of {row['published']}, {float(row['share']):.1f} % | {row['p50_ms']}, "
                   f"{row['p99_ms']}, {row['max_ms']} | {row['kb_per_s']} | {back} | {row['before_mb']}, {row['after_mb']} | "
                   f"{row['out_of_order']} |")
    out += ["", lines[0].lstrip("# ") + "."]
    text = "\n".join(out)
    print(text)
    with open(page, encoding="utf-8") as file:
        old = file.read()
    new, count = re.subn(r"<!-- faults -->.*?<!-- /faults -->",
                         lambda _: f"<!-- faults -->\n{text}\n<!-- /faults -->", old, flags=re.DOTALL)
    if count != 1:
        sys.exit(f"{page}: has no <!-- faults --> ... <!-- /faults -->")
    with open(page, "w", encoding="utf-8") as file:
        file.write(new)


if __name__ == "__main__":
    main(*sys.argv[1:])
