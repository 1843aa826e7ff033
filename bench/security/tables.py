#!/usr/bin/env python3
"""Renews the tables of docs/measurements/security.md from the results of cost.sh, floods.py and nat.sh.

usage: tables.py cost|floods|nat RESULT PAGE
"""

import os
import statistics
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from page_table import put_table, read_numbers

FLOODS = {"none": "none", "garbage": "garbage", "handshakes": "announcements of strangers", "endless": "the same, leases that never end",
          "replay": "replayed datagrams", "after": "none, afterwards"}


def median(rows, key):
    return statistics.median(row[key] for row in rows)


def renew_cost(result, page):
    rows, comment = read_numbers(result)
    lines = ["| sites | readers | keys | site, reader [% of a core] | all, with keys / without | age p50, p99 [ms] | frames complete, worst reader "
             "| per frame: datagrams, kB | all see all after [s] |", "|---|---|---|---|---|---|---|---|---|"]
    for sites, readers in sorted({(row["sites"], row["subscribers"]) for row in rows}):
        alike = [row for row in rows if (row["sites"], row["subscribers"]) == (sites, readers)]
        use = {}
        for keys in ("open", "closed"):
            of_case = [row for row in alike if row["case"] == keys]
            site, reader = median(of_case, "site_percent"), median(of_case, "subscriber_percent")
            use[keys] = sites * site + readers * reader
            ratio = f"{use['closed'] / use['open']:.2f}" if keys == "closed" else ""
            lines.append(f"| {sites:.0f} | {readers:.0f} | {'yes' if keys == 'closed' else 'no'} | {site:.1f}, {reader:.1f} | {ratio} | "
                         f"{median(of_case, 'p50_ms'):.2f}, {median(of_case, 'p99_ms'):.2f} | {100 * min(r['share'] for r in of_case):.2f} %, "
                         f"{100 * min(r['worst_share'] for r in of_case):.2f} % | {median(of_case, 'datagrams_per_frame'):.1f}, "
                         f"{median(of_case, 'kb_per_frame'):.1f} | {median(of_case, 'seen_s'):.2f} |")
    rounds = len(rows) // max(1, 2 * len({(row["sites"], row["subscribers"]) for row in rows}))
    put_table(page, "cost", lines, f"{comment}; medians of {rounds} rounds in turn, {rows[0]['seconds']:.0f} s each")


def renew_floods(result, page):
    rows, comment = read_numbers(result)
    lines = ["| flood | datagrams/s | frames | share | longest gap [ms] | age p50 [ms] | site, world server [% of a core] "
             "| both: MB before, most, after |", "|---|---|---|---|---|---|---|---|"]
    for row in rows:
        lines.append(f"| {FLOODS[row['flood']]} | {row['sent_per_s']:.0f} | {row['received']:.0f} of {row['received'] + row['missing']:.0f} | "
                     f"{100 * row['share']:.2f} % | {row['longest_gap_ms']:.0f} | {row['median_ms']:.1f} | "
                     f"{row['site_percent']:.0f}, {row['world_percent']:.0f} | {row['mb_before']:.0f}, {row['mb_most']:.0f}, {row['mb_after']:.0f} |")
    put_table(page, "floods", lines, f"{comment}; {rows[0]['seconds']:.0f} s each")


def renew_nat(result, page):
    rows, comment = read_numbers(result)
    row = rows[0]
    lines = ["| from `keys init` until both people are in one picture | counted | frames of alice, bob that came | missing | longest gap | "
             "age p50 | alice's home gets another address: back after |", "|---|---|---|---|---|---|---|",
             f"| {row['until_picture_s']:.1f} s | {row['seconds']:.0f} s | {row['alice_received']:.0f}, {row['bob_received']:.0f} | "
             f"{row['alice_missing']:.0f}, {row['bob_missing']:.0f} | {max(row['alice_gap_ms'], row['bob_gap_ms']):.0f} ms | "
             f"{row['alice_median_ms']:.0f}, {row['bob_median_ms']:.0f} ms | {row['moved_gap_ms'] / 1000:.1f} s |"]
    put_table(page, "nat", lines, comment)


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("cost", "floods", "nat"):
        sys.exit(__doc__)
    {"cost": renew_cost, "floods": renew_floods, "nat": renew_nat}[sys.argv[1]](sys.argv[2], sys.argv[3])
