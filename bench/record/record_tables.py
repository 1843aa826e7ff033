#!/usr/bin/env python3
"""Renews the tables of docs/measurements/recording.md from the results of raw_codecs.sh and record_site.sh.

usage: record_tables.py codecs|site CSV PAGE    the table goes between <!-- codecs --> and <!-- /codecs -->, or those of "record_site"
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_numbers


def codecs(path, page):
    """Only with the colours apart, by the noise in the middle; the file has the rest."""
    rows, comment = read_numbers(path)
    apart = [row for row in rows if row["arrangement"] == "colours apart"]
    levels = sorted({row["noise_lsb"] for row in rows})
    lines = ["| codec | " + " | ".join(f"of raw, noise {level:g}" for level in levels) + " | mosaic as it is, noise 2 | encode [ms] | decode [ms] | "
             "MB/s of a core | cores for 240 MB/s |", "|" + "---|" * (len(levels) + 6)]
    for name in dict.fromkeys(row["codec"] for row in apart):
        own = {row["noise_lsb"]: row for row in apart if row["codec"] == name}
        mosaic = [row for row in rows if row["codec"] == name and row["arrangement"] == "mosaic" and row["noise_lsb"] == 2]
        cells = [f"{own[level]['of_raw']:.2f}" for level in levels] + [f"{mosaic[0]['of_raw']:.2f}"]
        cells += [f"{own[2]['encode_ms']:.1f}", f"{own[2]['decode_ms']:.1f}", f"{own[2]['mb_per_s']:.0f}", f"{own[2]['cores_for_8']:.2f}"]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    if any(row["lossless"] != "yes" for row in rows):
        sys.exit(f"{path}: a codec changed pictures")
    put_table(page, "codecs", lines, comment)


def site(path, page):
    rows, comment = read_numbers(path)
    lines = ["| `record.codec` | metaframes [1/s] | late | median [ms] | p99 [ms] | cores, all | written | dropped | to disk [MB/s] | of raw |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        lines.append(f"| {row['codec']} | {row['rate_hz']:.1f} | {row['late']:.0f} | {row['median_ms']:.1f} | {row['p99_ms']:.1f} | {row['cores']:.2f} | "
                     f"{row['written']:.0f} | {row['dropped']:.0f} | {row['mb_per_s']:.0f} | {row['of_raw']:.2f} |")
    put_table(page, "record_site", lines, comment)


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("codecs", "site"):
        sys.exit(__doc__)
    (codecs if sys.argv[1] == "codecs" else site)(sys.argv[2], sys.argv[3])
