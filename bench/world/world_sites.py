#!/usr/bin/env python3
"""Runs simulated sites with a world server and a viewer, and renews the table of docs/measurements/world.md.

usage: world_sites.py measure BUILD STREAM SECONDS SITES...    rows of comma-separated values, one for each number of sites
       world_sites.py table TABLE PAGE    the table goes between <!-- world-sites --> and <!-- /world-sites -->
"""

import json
import os
import shlex
import signal
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from demo_run import read_stat
from page_table import put_table, read_rows

SETTLE_S = 4.0  # time for the programs to find each other
PATIENCE_S = 30.0
FIELDS = ["sites", "steps_per_s", "skipped_ticks", "meshes_per_s", "dropped_meshes", "prepare_ms", "prepare_p99_ms", "step_ms",
          "collision_ms", "collision_p99_ms", "world_share", "viewer_share", "site_share", "world_mb"]


def cpu_s(process):
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        return read_stat(file.read())["cpu_s"]


class Programs:
    """Programs of one case, with a folder of logs. All end with this object."""

    def __init__(self, build, folder):
        self.build, self.folder, self.started = build, folder, []

    def start(self, name, *arguments):
        log = open(os.path.join(self.folder, f"{len(self.started)}-{name}.log"), "wb")
        command = shlex.split(os.environ.get("RUN", "")) + [os.path.join(self.build, "bin", name), *arguments]
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        log.close()
        self.started.append(process)
        return process

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.started):
            process.send_signal(signal.SIGINT)
        for process in self.started:
            try:
                process.wait(15.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def read_reports(path):
    reports = []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            try:
                reports.append(json.loads(line))
            except json.JSONDecodeError:
                pass  # a log line, or an incomplete line
    return reports


def world_of(report):
    found = [program for program in report["programs"] if program["kind"] == "world_server" and program["state"] == "present"]
    return found[0] if found else None


def measure(build, stream, seconds, num_sites):
    with tempfile.TemporaryDirectory() as folder, Programs(build, folder) as programs:
        name = f"world-sites-{os.getpid()}"
        bus = ["--bus.world", name]
        world = programs.start("world_server", "--config", "deploy/worlds/demo.toml", *bus)
        viewer = programs.start("viewer", "--config", "deploy/viewer.toml", "--headless", *bus)
        sites = [programs.start("replayed_site", "--stream", stream, "--name", f"site{i}", *bus) for i in range(num_sites)]
        programs.start("monitor", "--json", *bus)
        log = os.path.join(folder, f"{len(programs.started) - 1}-monitor.log")
        patience = time.monotonic() + PATIENCE_S
        while True:
            reports = read_reports(log)
            newest = world_of(reports[-1]) if reports else None
            if newest and newest["latencies"].get("capture_to_collision", {}).get("median_ms"):
                break
            if time.monotonic() > patience or any(process.poll() is not None for process in programs.started):
                for file in sorted(os.listdir(folder)):
                    with open(os.path.join(folder, file), encoding="utf-8", errors="replace") as text:
                        sys.stderr.write(f"{file}: {text.read()[-500:]}\n")
                sys.exit("the programs did not find each other, or one ended")
            time.sleep(0.2)
        time.sleep(SETTLE_S)
        measured = [world, viewer, *sites]
        begin_s, begin = time.monotonic(), [cpu_s(process) for process in measured]
        num_before = len(read_reports(log))
        time.sleep(seconds)
        end = [cpu_s(process) for process in measured]
        length_s = time.monotonic() - begin_s
        shares = [(after - before) / length_s for before, after in zip(begin, end)]
        reports = [report for report in read_reports(log)[num_before:] if world_of(report)]
        seen = list(map(world_of, reports))
        if len(seen) < 2:
            sys.exit("the monitor saw too little of the world server")

    def median(stage, value):
        found = [s["latencies"][stage][value] for s in seen if s["latencies"].get(stage, {}).get(value) is not None]
        return (max if value == "p99_ms" else statistics.median)(found) if found else float("nan")

    def grown(group, count):
        return seen[-1][group][count]["total"] - seen[0][group][count]["total"]

    between_s = (reports[-1]["time_ns"] - reports[0]["time_ns"]) / 1e9
    return {
        "sites": num_sites, "steps_per_s": statistics.median(s["rate"] for s in seen), "skipped_ticks": grown("losses", "skipped_ticks"),
        "meshes_per_s": grown("work", "meshes_received") / between_s, "dropped_meshes": grown("losses", "meshes_dropped"),
        "prepare_ms": median("prepare", "median_ms"), "prepare_p99_ms": median("prepare", "p99_ms"), "step_ms": median("step", "median_ms"),
        "collision_ms": median("capture_to_collision", "median_ms"), "collision_p99_ms": median("capture_to_collision", "p99_ms"),
        "world_share": shares[0], "viewer_share": shares[1], "site_share": statistics.fmean(shares[2:]),
        "world_mb": seen[-1]["resident_bytes"] / 1e6,
    }


def table(path, page):
    rows, comment = read_rows(path)
    out = ["| sites | steps/s | ticks skipped | meshes/s | dropped for a newer one | preparing a mesh, median, p99 [ms] | step [ms] | "
           "capture to collision, median, p99 [ms] | world server, of a core | viewer | each site | memory of the world server [MB] |",
           "|" + "---|" * 12]
    for row in rows:
        f = {key: float(value) for key, value in row.items()}
        out.append(f"| {row['sites']} | {f['steps_per_s']:.0f} | {f['skipped_ticks']:.0f} | {f['meshes_per_s']:.0f} | {f['dropped_meshes']:.0f} | "
                   f"{f['prepare_ms']:.1f}, {f['prepare_p99_ms']:.1f} | {f['step_ms']:.2f} | {f['collision_ms']:.1f}, {f['collision_p99_ms']:.1f} | "
                   f"{f['world_share']:.0%} | {f['viewer_share']:.0%} | {f['site_share']:.0%} | {f['world_mb']:.0f} |")
    put_table(page, "world-sites", out, comment)


def main(command, *arguments):
    if command == "table":
        return table(*arguments)
    build, stream, seconds, *numbers = arguments
    print(",".join(FIELDS))
    for number in map(int, numbers):
        row = measure(build, stream, float(seconds), number)
        print(",".join(f"{row[field]:.4g}" if isinstance(row[field], float) else str(row[field]) for field in FIELDS), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
