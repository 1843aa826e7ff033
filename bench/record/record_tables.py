#!/usr/bin/env python3
"""Renews the tables of docs/measurements/recording.md from the results of raw_codecs.sh, record_site.sh and record_faults.sh.

usage: record_tables.py codecs|site|faults RESULT PAGE    the table goes between <!-- NAME --> and <!-- /NAME -->, NAME being
                                                          codecs, record_site or record_faults
"""

import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine
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


def faults(path, page):
    with open(path, encoding="utf-8") as file:
        result = json.load(file)
    rows = []
    for name, fault in (("kill", "`record` is killed"), ("room_kill", "a site with `--record` is killed")):
        lost_ms = [run["loss_s"] * 1e3 for run in result[name]["runs"]]
        rows.append([f"{fault}, {len(lost_ms)} times", f"lost: the last {min(lost_ms):.0f} to {max(lost_ms):.0f} ms"])
    described = {
        "full_disk": ("a disk of 8 MB gets full", "exit code {exit}; {samples} samples, all whole; {dropped} dropped"),
        "standing_disk": ("the disk stands still for 5 s, `--buffer_mb 1`", "{dropped} samples dropped, {dropped_in_log} according to the log"),
        "clock_set_back": ("the clock is set back by 1 h", "times go on, without a gap of more than {longest_gap_s:.2f} s")}
    for name, (fault, text) in described.items():
        figures = result[name]
        rows.append([fault, f"not measured: {figures['skipped']}" if "skipped" in figures else text.format(**figures)])
    lines = ["| fault | result |", "|---|---|"] + ["| " + " | ".join(row) + " |" for row in rows]
    put_table(page, "record_faults", lines, machine.origin_line(result["origin"]))


TABLES = {"codecs": codecs, "site": site, "faults": faults}

if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in TABLES:
        sys.exit(__doc__)
    TABLES[sys.argv[1]](sys.argv[2], sys.argv[3])
