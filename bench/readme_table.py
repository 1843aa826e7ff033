#!/usr/bin/env python3
"""Makes tables from the newest committed files of bench/results: "demo" in README.md, "parts" and "recordings" in
docs/measurements/README.md. Each table goes between <!-- NAME --> and <!-- /NAME -->.

usage: readme_table.py            renews the tables of both pages
       readme_table.py --check    fails if a table differs from what the newest committed files give; changes nothing
"""

import glob
import json
import os
import re
import sys

import machine
from page_table import between, read_rows, renew

README = os.path.join(machine.ROOT, "README.md")
OVERVIEW = os.path.join(machine.ROOT, "docs", "measurements", "README.md")


def results_files(kind="demo.json"):
    """The committed (or added) results of one kind; without git, all files."""
    pattern = f"bench/results/*-{kind}"
    listed = machine.git("ls-files", "--", pattern)
    if listed is None:
        return sorted(glob.glob(os.path.join(machine.ROOT, pattern)))
    return [os.path.join(machine.ROOT, file) for file in listed.splitlines() if os.path.exists(os.path.join(machine.ROOT, file))]


def load(file):
    with open(file, encoding="utf-8") as stream:
        return json.load(stream)


def newest(files):
    """The file of the latest measurement."""
    return max(files, key=lambda file: (load(file)["date"], file)) if files else None


def number(value, digits=1):
    return "not counted" if value is None else f"{value:.{digits}f}"


def each(names, text):
    return " and ".join(text(name) for name in names)


def latency(report):
    return f"{report['median']:.0f} ms; {report['p99']:.0f} ms"


def machine_line(kept):
    one, all_cores = kept["score"]["one_core"]["score"], kept["score"]["all_cores"]["score"]
    state = "" if kept["quiet"] else " **not quiet**:"
    runs = len(kept["runs"])
    return (f"{kept['machine']} with {kept['cores']} cores, machine score {one:.0f} on one core and {all_cores:.0f} on all at once "
            f"([what 100 is](docs/measuring.md)); {kept['date'][:10]}, commit {kept['commit']}{' with changes' if kept['dirty'] else ''}, "
            f"{kept['figures']['seconds']:.0f} s"
            f"{f', medians of {runs} runs' if runs > 1 else ''};{state} others used {kept['figures']['others_share']:.1%} of the machine.")


def gave_way_rows(viewer):
    """How far the viewer reduced its quality on a slow machine; "" in results of viewers that cannot."""
    if viewer.get("scale") is None:
        return []
    shadows = "with shadows" if viewer["shadows"] > 0.5 else "without shadows"
    return [("viewer, most of the time: pictures/s that it allows itself; resolution of the scene",
             f"{viewer['max_frames_per_s']:.0f}; {viewer['scale']:.0%} of the picture's width and height, {shadows}")]


def start_row(sites, figures):
    """Start times as the programs report them; in results without these, from the logs."""
    report = figures["report"]
    first = {**{name: report["sites"][name].get("first_output_s") for name in sites},
             **{name: report[name].get("first_output_s") for name in ("world", "viewer")}}
    text = "from the start to a site's first metaframe, the world server's first state, the viewer's first picture"
    if all(value is None for value in first.values()):
        first = figures["start_s"]
        text = "start until the viewer shows a site's person, until the world server runs, until the viewer can draw"
    return text, f"{each(sites, lambda name: number(first.get(name)))}, {number(first.get('world'))}, {number(first.get('viewer'))} s"


def demo_table(kept):
    """The page's text for the content of a results file."""
    figures = kept["figures"]
    report, programs = figures["report"], figures["programs"]
    sites = sorted(report["sites"])
    site = report["sites"]
    world, viewer = report["world"], report["viewer"]
    everybody = [*sites, "world", "viewer"]
    dropped = sum(site[name]["dropped"] for name in sites)
    offered = dropped + sum(site[name]["metaframes_published"] for name in sites)
    rows = [
        ("metaframes/s of each site (the rooms deliver 30)", each(sites, lambda name: number(figures["rates"][name]))),
        ("metaframes dropped, of both sites", f"{dropped:.0f} of {offered:.0f}"),
        ("capture to publish: median; 99th percentile of the worst second",
         " and ".join(latency(site[name]["capture_to_publish_ms"]) for name in sites)),
        ("capture to collision: median; 99th percentile of the worst second", latency(world["capture_to_collision_ms"])),
        ("capture to display: median; 99th percentile of the worst second", latency(viewer["capture_to_display_ms"])),
        ("viewer pictures/s; physics steps/s", f"{viewer['frames_per_s']:.1f}; {world['steps_per_s']:.0f}"),
        *gave_way_rows(viewer),
        ("bytes/s of each site, mesh and textures", each(sites, lambda name: f"{site[name]['bytes_per_s'] / 1e6:.2f}") + " MB/s"),
        ("processor time per metaframe: a site, world server, viewer",
         f"{each(sites, lambda name: number(programs[name]['processor_ms_per_metaframe']))}, "
         f"{number(programs['world']['processor_ms_per_metaframe'])}, {number(programs['viewer']['processor_ms_per_metaframe'])} ms"),
        ("waiting for a processor per metaframe: a site, world server, viewer",
         f"{each(sites, lambda name: number(programs[name]['waiting_ms_per_metaframe']))}, "
         f"{number(programs['world']['waiting_ms_per_metaframe'])}, {number(programs['viewer']['waiting_ms_per_metaframe'])} ms"),
        ("share of one core: a site, world server, viewer",
         f"{each(sites, lambda name: format(programs[name]['core_share'], '.0%'))}, "
         f"{programs['world']['core_share']:.0%}, {programs['viewer']['core_share']:.0%}"),
        ("memory: a site, world server, viewer; of that, mapped files",
         ", ".join(f"{programs[name]['memory_mb']['resident']:.0f}" for name in everybody) + "; "
         + ", ".join(f"{programs[name]['memory_mb']['of_files']:.0f}" for name in everybody) + " MB"),
        start_row(sites, figures),
    ]
    lines = [machine_line(kept), "", "| `make demo`, 2 sites of 8 cameras, 640x480 each, video on | |", "|---|---|"]
    return "\n".join(lines + [f"| {name} | {value} |" for name, value in rows])


def newest_rows(kind):
    """Rows of the CSV file of a kind whose first line has the latest date and time, and "machine, score, date" of it."""
    tables = [read_rows(file) for file in results_files(kind)]
    if not tables:
        return [], ""
    rows, comment = max(tables, key=lambda table: table[1])  # comments begin with the date
    return rows, measured_on(comment)


def measured_on(comment):
    """ "MACHINE, score, date" of the first line of a CSV file: "DATE, MACHINE, ..." or "DATE, commit C, MACHINE, ..." with "machine
    score N" somewhere, or without."""
    date, *others = comment.split(", ")
    name = next(part for part in others if not part.startswith("commit "))
    score = re.search(r"machine score ([\d.]+)", comment)
    return f"{name}, {f'score {float(score.group(1)):.0f}' if score else 'score not measured'}, {date[:10]}"


def only(rows, **wanted):
    found = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    return found[0] if found else None


def parts_table():
    """Figures of the parts alone, each from its own script."""
    lines = ["| alone | measured | machine | by |", "|---|---|---|---|"]
    rows, where = newest_rows("site-8x1mp.csv")
    row = only(rows, format="BayerRG8", offered_hz="60", workers="2")
    if row:
        lines.append(f"| site: 8 cameras of 1 MP at 60/s, raw pictures to coded bytes, 2 cores | {float(row['rate_hz']):.1f}/s; median "
                     f"{float(row['median_ms']):.1f}, 99th percentile {float(row['p99_ms']):.1f} ms; {float(row['core_ms']):.1f} ms of a core and "
                     f"{float(row['kilobytes']):.0f} kB per metaframe | {where} | `bench/site/site_8x1mp.sh` |")
    rows, where = newest_rows("hull-sets.csv")
    for name, text in (("person_10k", "8 views"), ("person_24views", "24 views")):
        one, two = only(rows, set=name, threads="1"), only(rows, set=name, threads="2")
        if one and two:
            lines.append(f"| hull of {int(one['triangles']):,} triangles, {text}, 1 and 2 threads | {float(one['total_ms']):.1f} and "
                         f"{float(two['total_ms']):.1f} ms | {where} | `bench/hull/hull_curves.sh` |")
    rows, where = newest_rows("world-step.csv")
    row = only(rows, sweep="standard")
    if row:
        lines.append(f"| world server: a person's mesh of {int(row['triangles']):,} triangles for the physics; a step with {row['people']} people and "
                     f"{row['bodies']} bodies | {float(row['shape_ms']):.1f}; {float(row['median_ms']):.1f} ms of a core | {where} | `bench/world/world_step.sh` |")
    rows, where = newest_rows("viewer-speed.csv")
    row = only(rows, case="two people of 8 cameras come ready made")
    if row:
        triangles = " and ".join(f"{int(n):,}" for n in row["triangles"].split())
        lines.append(f"| viewer: two people of {triangles} triangles, {row['width']}x{row['height']}, in software | {row['frames_per_s']} pictures/s | {where} "
                     f"| `bench/viewer/viewer_speed.sh` |")
    return "\n".join(lines)


def recordings_table():
    """Hulls of recordings, with all views of each."""
    rows, where = newest_rows("hull-masks.csv")
    lines = ["| recording | views | hull | coverage of the silhouettes: mean, worst view | 1 and 2 threads |", "|---|---|---|---|---|"]
    for name in sorted({row["recording"] for row in rows}):
        views = max((row["views"] for row in rows if row["recording"] == name), key=int)
        one, two = (only(rows, recording=name, views=views, threads=threads) for threads in ("1", "2"))
        lines.append(f"| {name} | {views} | {float(one['volume_l']):.1f} litres, {int(one['triangles']):,} triangles | "
                     f"{float(one['coverage_mean_percent']):.1f} %, {float(one['coverage_worst_percent']):.1f} % | "
                     f"{float(one['total_ms']):.1f} and {float(two['total_ms']):.1f} ms |")
    return "\n".join(lines + ["", f"{where}, by `bench/hull/hull_curves.sh`."])


def tables(demo_file):
    """[(page, marker, text)] of all tables."""
    return [(README, "demo", demo_table(load(demo_file))), (OVERVIEW, "parts", parts_table()), (OVERVIEW, "recordings", recordings_table())]


def renew_pages(demo_file):
    for page, name, text in tables(demo_file):
        renew(page, name, text)


def check():
    file = newest(results_files())
    if file is None:
        return "no bench/results/*-demo.json found; run make bench-demo"
    wrong = [f"{name} in {os.path.relpath(page, machine.ROOT)}" for page, name, text in tables(file) if between(page, name) != text]
    if wrong:
        return (f"tables differ from the newest committed results: {', '.join(wrong)} (the demo's: {os.path.relpath(file, machine.ROOT)}). "
                "`git add` newer results, or renew the tables: bench/readme_table.py")
    return None


def main(arguments):
    if arguments == ["--check"]:
        wrong = check()
        if wrong:
            sys.exit(f"readme_table: {wrong}")
        print("the tables of README.md and docs/measurements/README.md are those of the newest committed results")
    elif not arguments:
        file = newest(results_files())
        if file is None:
            sys.exit("readme_table: no bench/results/*-demo.json found; run make bench-demo")
        renew_pages(file)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
