#!/usr/bin/env python3
"""Renews the table of docs/measurements/codecs.md from the results of codec_table.sh.

usage: codec_table.py TABLE PAGE    the table goes between <!-- codec --> and <!-- /codec -->
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_rows

COLUMNS = [("quality", "quality", "{:.0f}"), ("mesh_kb", "mesh", "{:.1f}"), ("masks_kb", "masks", "{:.1f}"),
           ("colours_kb", "colours", "{:.1f}"), ("total_kb", "all [kB]", "{:.1f}"), ("psnr_db", "PSNR [dB]", "{:.2f}"),
           ("worst_psnr_db", "worst camera", "{:.2f}"), ("luma_psnr_db", "Y", "{:.2f}"), ("rgb_psnr_db", "RGB", "{:.2f}"),
           ("crop_ms", "cut out [ms]", "{:.2f}"), ("encode_ms", "encode [ms]", "{:.2f}"), ("decode_ms", "decode [ms]", "{:.2f}")]
PAPER_KB = 1450.0


def main(table, page):
    rows, comment = read_rows(table)
    out = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        own = [row for row in rows if row["scene"] == scene]
        first = own[0]
        out += [f"{scene.capitalize() if ' ' in scene else scene}: {first['views']} views, {first['triangles']} triangles of "
                f"{float(first['position_bits']):.0f} bits ({float(first['encode_mesh_ms']):.2f} ms to encode, "
                f"{float(first['decode_mesh_ms']):.2f} to decode), {int(first['subject_px']):,} texels show the subject.", "",
                "| " + " | ".join(name for _, name, _ in COLUMNS) + " | of 1.45 MB |",
                "|" + "---|" * (len(COLUMNS) + 1)]
        for row in own:
            cells = [form.format(float(row[key])) for key, _, form in COLUMNS]
            cells.append(f"1/{PAPER_KB / float(row['total_kb']):.0f}")
            out.append("| " + " | ".join(cells) + " |")
        out.append("")
    put_table(page, "codec", out[:-1], comment)


if __name__ == "__main__":
    main(*sys.argv[1:])
