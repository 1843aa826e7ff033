#!/usr/bin/env python3
"""Renews the table of docs/design/dependencies.md from the results of libraries.sh.

usage: libraries.py TABLE PAGE    the table goes between <!-- libraries --> and <!-- /libraries -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows


def main(table, page):
    rows, comment = read_rows(table)
    out = ["| work | by | ms | bytes |", "|---|---|---|---|"]
    out += [f"| {row['work']} | {row['by']} | {float(row['ms']):.2f} | {row['bytes']} |" for row in rows]
    put_table(page, "libraries", out, comment)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
