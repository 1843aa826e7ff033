#!/usr/bin/env python3
"""Renews the table of docs/measurements/site.md from what site_8x1mp.sh keeps.

usage: site_8x1mp.py CSV PAGE    the table goes between <!-- site_8x1mp --> and <!-- /site_8x1mp -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import read_numbers, renew, table

# Petit et al., Multicamera Real-Time 3D Modeling for Telepresence and Remote Collaboration (2010)
PAPER = ["8 cameras of 1 MP, ten dual-Xeon PCs (Petit et al., 2010)", "20", "20", "", "below 100", "", "", "", "", "", "", ""]


def offered(row):
    return f"{row['offered_hz']:.0f}" if row["offered_hz"] > 0 else "one after another"


def cells(row):
    return [f"{row['format']}, {row['workers']:.0f} cores", offered(row), f"{row['rate_hz']:.1f}",
            f"{100 * row['late'] / row['offered']:.1f}",
            f"{row['median_ms']:.1f}", f"{row['p90_ms']:.1f}", f"{row['p99_ms']:.1f}", f"{row['max_ms']:.1f}",
            f"{row['silhouettes_ms']:.1f}", f"{row['hull_ms']:.1f}", f"{row['encode_ms']:.1f}", f"{row['core_ms']:.1f}"]


def main(path, page):
    rows, comment = read_numbers(path)
    head = ["pictures", "offered [1/s]", "ready [1/s]", "dropped [%]", "median [ms]", "p90 [ms]", "p99 [ms]", "max [ms]",
            "silhouettes [ms]", "hull [ms]", "coding [ms]", "core time [ms]"]
    text = table(f"site_8x1mp ({comment})", head, [cells(row) for row in rows] + [PAPER])
    renew(page, "site_8x1mp", f"{comment}:\n\n{text}")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[1].endswith("-8x1mp.csv"):
        sys.exit(__doc__)
    main(*sys.argv[1:])
