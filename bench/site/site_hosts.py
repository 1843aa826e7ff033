"""Measures a site on several hosts against the same site as one process: see site_hosts.sh."""

import argparse
import atexit
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine  # noqa: E402
import page_table  # noqa: E402
from hosts_network import (  # noqa: E402
    HOSTS,
    NODES,
    SITE,
    Network,
    enter_namespaces,
    program,
    render_room,
    report_of,
    write_one_process,
    write_regions,
)

PAGE = os.path.join(machine.ROOT, "docs", "measurements", "site_hosts.md")
SETTLE_S = 6.0
REGIONS_HZ = 15  # two hulls of sixteen views; the cores are those of one machine


def latency(of, stage):
    return of["latencies"].get(stage)


def count(of, part, what):
    return of[part].get(what, {"total": 0})["total"]


def measure(network, options, folder, kind):
    """One run; a dictionary of its figures."""
    world = f"site-hosts-{os.getpid()}"
    name_of_kind, site, with_hosts, hulls_on = kind
    common = ["--bus.world", world]
    programs = []
    with open(os.path.join(folder, "programs.log"), "a", encoding="utf-8") as log:
        def start(host, name, *arguments):
            programs.append(network.start(host, [f"{options.build}/bin/{name}", *arguments, *common], log))
            atexit.register(programs[-1].kill)

        cache = ["--simulation.cache", options.cache]
        if with_hosts:
            for node in NODES:
                start(node, "camera_node", "--config", site, "--host", node, *cache)
            for host in hulls_on:
                start(host, "site_node", "--config", site, "--host", host)
        else:
            start("hull", "site_node", "--config", site, *cache)
        start("world", "world_server", "--config", os.path.join(machine.ROOT, "deploy", "worlds", "demo.toml"))
        start("viewer", "viewer", "--headless", "--view.width", "320", "--view.height", "180", "--view.max_fps", "10")
        time.sleep(SETTLE_S)
        before_bytes = {host: network.bytes_of(host) for host in HOSTS}
        before, began = machine.CpuTimes.now(), time.monotonic()
        first = report_of(network, options.build, world)
        time.sleep(options.seconds)
        last = report_of(network, options.build, world)
        lasted = time.monotonic() - began
        used = machine.shares(before, machine.CpuTimes.now())
        after_bytes = {host: network.bytes_of(host) for host in HOSTS}
        for each in programs:
            each.send_signal(signal.SIGTERM)
        for each in programs:
            each.wait(timeout=30)
    site_first, site_last = program(first, "site"), program(last, "site")
    # the counts are as old as the site's status
    between_s = 1e-9 * (last["time_ns"] - first["time_ns"]) - (site_last["status_age_s"] - site_first["status_age_s"])
    viewer = program(last, "viewer")
    nodes = [p for p in last["programs"] if p["kind"] == "camera_node"]
    figures = {
        "kind": name_of_kind,
        "seconds": lasted,
        "busy": used["others"],
        "metaframes_per_s": (count(site_last, "work", "metaframes_published") - count(site_first, "work", "metaframes_published")) / between_s,
        "dropped": sum(
            count(site_last, "losses", what) - count(site_first, "losses", what)
            for what in ("dropped_incomplete", "dropped_late", "pictures_missing", "failed")
        ),
        "capture_to_publish": latency(site_last, "capture_to_publish"),
        "hull_ms": latency(site_last, "hull")["median_ms"],
        "coding_ms": latency(site_last, "coding")["median_ms"],
        "silhouettes_ms": latency(site_last, "silhouettes")["median_ms"],
        "capture_to_display": latency(viewer, "capture_to_display") if viewer else None,
        "processor": {
            p["name"] if p["kind"] != "site" else "site": p["processor"]["cores"] for p in last["programs"] if p["processor"]
        },
        "capture_to_silhouette": [latency(node, "capture_to_silhouette")["median_ms"] for node in nodes],
        "mbit_per_s": {
            host: [8e-6 * (after_bytes[host][way] - before_bytes[host][way]) / lasted for way in (0, 1)] for host in HOSTS
        },
    }
    return figures


def text_of(figures):
    latency_of = figures["capture_to_publish"]
    return (
        f"{figures['kind']}: {figures['metaframes_per_s']:.1f} metaframes/s, "
        f"capture to publish {latency_of['median_ms']:.1f} ms (p99 {latency_of['p99_ms']:.1f}), hull {figures['hull_ms']:.1f} ms, "
        f"{figures['dropped']} dropped or missing, machine busy {figures['busy']:.0%}"
    )


def middle(runs, get):
    return statistics.median(get(one) for one in runs)


def predicted(build, site):
    """What `atrium plan` says of all hosts on the cores of this machine; without the world server and the viewer."""
    command = [f"{build}/bin/plan", site, "--simulate", "--shared-cores", str(machine.num_cores()), "--json"]
    plan = json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)
    links = {host["name"]: [host["out_mbit_per_s"], host["in_mbit_per_s"]] for host in plan["hosts"]}
    return {**plan["simulation"], "links": links}


def write_page(kinds, runs, predictions, origin):
    columns = [(name, [figures for figures in runs if figures["kind"] == name]) for name, *_ in kinds]
    rows = [
        ("metaframes/s", lambda f: f["metaframes_per_s"], "{:.1f}"),
        ("capture to publish, median [ms]", lambda f: f["capture_to_publish"]["median_ms"], "{:.1f}"),
        ("capture to publish, p99 [ms]", lambda f: f["capture_to_publish"]["p99_ms"], "{:.1f}"),
        ("silhouettes [ms]", lambda f: f["silhouettes_ms"], "{:.1f}"),
        ("hull [ms]", lambda f: f["hull_ms"], "{:.1f}"),
        ("coding [ms]", lambda f: f["coding_ms"], "{:.1f}"),
        ("dropped, or pictures missing", lambda f: f["dropped"], "{:.0f}"),
        ("machine busy", lambda f: f["busy"], "{:.0%}"),
    ]
    lines = ["| | " + " | ".join(name for name, _ in columns) + " |", "|---|" + "---|" * len(columns)]
    for name, get, form in rows:
        lines.append(f"| {name} | " + " | ".join(form.format(middle(part, get)) for _, part in columns) + " |")
    for name, key in ("predicted by `atrium plan`, median [ms]", "median_ms"), ("predicted, p99 [ms]", "p99_ms"):
        lines.append(f"| {name} | " + " | ".join(f"{one[key]:.1f}" for one in predictions) + " |")
    for host in HOSTS:
        cells = []
        for _, part in columns:
            out, into = (middle(part, lambda f, w=way: f["mbit_per_s"][host][w]) for way in (0, 1))
            cells.append(f"{out:.2f} out, {into:.2f} in")
        lines.append(f"| link of {host} [Mbit/s] | " + " | ".join(cells) + " |")
        links = [one["links"].get(host) for one in predictions]
        if any(links):
            cells = [f"{link[0]:.2f} out, {link[1]:.2f} in" if link else "" for link in links]
            lines.append(f"| predicted, link of {host} [Mbit/s] | " + " | ".join(cells) + " |")
    page_table.put_table(PAGE, "site_hosts", lines, origin)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--runs", type=int, required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--inside", action="store_true", help="in namespaces of its own")
    options = parser.parse_args()
    options.build = os.path.abspath(options.build)
    options.cache = os.path.abspath(".cache/rooms")
    if not options.inside:
        score = machine.score(options.build)
        os.environ["ATRIUM_SCORE"] = json.dumps(score)
        enter_namespaces()
    score = json.loads(os.environ["ATRIUM_SCORE"])
    network = Network()
    runs = []
    with tempfile.TemporaryDirectory() as folder:
        one = write_one_process(folder)
        regions, one_regions = write_regions(folder, REGIONS_HZ)
        for site in one, one_regions:
            render_room(options.build, options.cache, site)
        with_regions = f"two people in two regions, {REGIONS_HZ}/s: "
        kinds = [
            ("one process", one, False, ["hull"]),
            ("several hosts", SITE, True, ["hull"]),
            (with_regions + "one process", one_regions, False, ["hull"]),
            (with_regions + "two hosts compute hulls", regions, True, ["helper", "hull"]),
        ]
        for _ in range(options.runs):
            for kind in kinds:
                runs.append(measure(network, options, folder, kind))
                print(text_of(runs[-1]), flush=True)
        predictions = [predicted(options.build, site) for _, site, *_ in kinds]
    short, is_changed = machine.commit()
    origin = (
        f"{machine.today():%Y-%m-%dT%H:%MZ}, commit {short}{' and changes' if is_changed else ''}, {machine.name()}, "
        f"{machine.num_cores()} cores, machine score {score['one_core']['score']:.1f}, {options.seconds:.0f} s, medians of {options.runs} runs each"
    )
    with open(options.out, "w", encoding="utf-8") as file:
        json.dump({"origin": origin, "runs": runs, "predictions": predictions}, file, indent=1)
    write_page(kinds, runs, predictions, origin)
    print(f"kept in {options.out}")


if __name__ == "__main__":
    main()
