#!/usr/bin/env python3
"""Renews the table of docs/measurements/segmentation.md from what segmentation_quality.sh keeps.

usage: segmentation_table.py TABLE PAGE [NAME]    the table goes between <!-- NAME --> and <!-- /NAME -->, by default "quality"
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows

METHODS = [("atrium", "Atrium"), ("atrium_unrefined", "Atrium, refine_outline = false"),
           ("mog2", "MOG2"), ("knn", "KNN"), ("mog2_best", "MOG2, best"), ("knn_best", "KNN, best")]
COLUMNS = [("iou", "{:.3f}"), ("false_in_shadow", "{:.2%}"), ("false_in_empty_room", "{:.3%}"), ("ms_per_mp", "{:.2f}")]


def mean(rows, column):
    values = [float(row[column]) for row in rows if row[column] != ""]
    return sum(values) / len(values) if values else None


def main(table, page, name="quality"):
    rows, comment = read_rows(table)
    out = ["| scene | method | IoU | false in shadow | false in the empty room | ms per MP |", "|---|---|---|---|---|---|"]
    for scene in dict.fromkeys(row["scene"] for row in rows):
        for method, title in METHODS:
            chosen = [row for row in rows if row["scene"] == scene and row["method"] == method]
            if not chosen:
                continue
            values = [mean(chosen, column) for column, _ in COLUMNS]
            cells = ["" if value is None else form.format(value) for value, (_, form) in zip(values, COLUMNS)]
            out.append(f"| {scene} | {title} | " + " | ".join(cells) + " |")
    put_table(page, name, out, comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
