"""Predicts large sites by `atrium plan`, with one hull and with regions on several hosts: see site_scale.sh."""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine  # noqa: E402
import page_table  # noqa: E402

PAGE = os.path.join(machine.ROOT, "docs", "measurements", "site_hosts.md")
WIDTH, HEIGHT, RATE_HZ = 1920, 1080, 60
PER_HOST = 4
SITES = [(16, 1, 16), (16, 2, 10), (64, 1, 64), (64, 8, 12)]  # cameras, regions, cameras that watch each region


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def rig(num_cameras):
    """Cameras around a person, in turn at four heights."""
    parts = [f'units = "m"\nrate_hz = {RATE_HZ}\n']
    for i in range(num_cameras):
        angle = 2 * math.pi * i / num_cameras
        centre = [4.0 * math.cos(angle), 4.0 * math.sin(angle), (1.0, 2.6, 1.8, 0.5)[i % 4]]
        z = unit([-centre[0], -centre[1], 1.05 - centre[2]])
        x = unit(cross(z, [0.0, 0.0, 1.0]))
        rows = [x, cross(z, x), z]
        move = [-sum(row[k] * centre[k] for k in range(3)) for row in rows]
        parts.append(
            f'[[camera]]\nname = "cam{i}"\nwidth = {WIDTH}\nheight = {HEIGHT}\nfx = 1100\nfy = 1100\ncx = {WIDTH / 2}\ncy = {HEIGHT / 2}\n'
            f"rotation = [{', '.join(repr(v) for row in rows for v in row)}]\ntranslation = [{', '.join(repr(v) for v in move)}]\n"
        )
    return "\n".join(parts)


def regions(num_cameras, num_regions, num_each):
    """Parts of a long hall; each is watched by the cameras beside it, some of which watch its neighbours, too."""
    text = ""
    for region in range(num_regions):
        first = region * num_cameras // num_regions - (num_each - num_cameras // num_regions) // 2
        names = ", ".join(f'"cam{i % num_cameras}"' for i in range(first, first + num_each))
        text += (
            f'[[hull.region]]\nname = "part{region}"\ncameras = [{names}]\n'
            f"bounds = {{ min = [{4.0 * region}, -3.0, 0.0], max = [{4.0 * region + 4.0}, 3.0, 2.6] }}\n"
            f'[[host]]\nname = "hull{region}"\ncores = 4\nlink_gbit_per_s = 10\nregions = ["part{region}"]\n'
        )
    return text


def site(num_cameras, num_regions, num_each):
    text = f'[site]\nname = "hall"\n[capture]\nsource = "cameras"\nrig = "rig.toml"\nrate_hz = {RATE_HZ}\n'
    for i in range(num_cameras):
        text += f'[[capture.camera]]\nname = "cam{i}"\nserial = "{i + 1}"\n'
    for host in range(num_cameras // PER_HOST):
        names = ", ".join(f'"cam{i}"' for i in range(host * PER_HOST, (host + 1) * PER_HOST))
        text += f'[[host]]\nname = "node{host}"\ncores = 4\nlink_gbit_per_s = 10\ncameras = [{names}]\n'
    text += regions(num_cameras, num_regions, num_each) if num_regions > 1 else ""
    return text + '[[host]]\nname = "model"\ncores = 4\nlink_gbit_per_s = 10\nmodel = true\n'


def plan(build, num_cameras, num_regions, num_each):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in ("rig.toml", rig(num_cameras)), ("site.toml", site(num_cameras, num_regions, num_each)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        command = [f"{build}/bin/plan", os.path.join(folder, "site.toml"), "--simulate", "--json"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            sys.exit(done.stderr)
        return json.loads(done.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True)
    parser.add_argument("--out", required=True)
    options = parser.parse_args()
    plans = [plan(options.build, *each) for each in SITES]
    nodes = [each["hosts"][0] for each in plans]
    models = [each["hosts"][-1] for each in plans]
    # the one with most work
    hulls = [max((h for h in each["hosts"] if "hull" in h["stages"]), key=lambda h: h["stages"]["hull"]["work_ms"]) for each in plans]

    def row(name, values):
        return f"| {name} | " + " | ".join(values) + " |"

    lines = [
        "| | " + " | ".join(f"{c} cameras" + (f", {r} regions of {n}" if r > 1 else ", one hull") for c, r, n in SITES) + " |",
        "|---|" + "---|" * len(SITES),
        row("hosts with four cameras; with hulls; model part", [f"{c // PER_HOST}; {r if r > 1 else 0}; 1" for c, r, _ in SITES]),
        row("load of a host with cameras", [f"{n['load']:.0%}" for n in nodes]),
        row("from its cameras [Mbit/s]", [f"{n['cameras_mbit_per_s']:.0f}" for n in nodes]),
        row("silhouettes and textures out of it [Mbit/s]", [f"{n['out_mbit_per_s']:.1f}" for n in nodes]),
        row("load of the model part's host", [f"{m['load']:.0%}" for m in models]),
        row("into it; out of it [Mbit/s]", [f"{m['in_mbit_per_s']:.0f}; {m['out_mbit_per_s']:.0f}" for m in models]),
        row("load of a host with a hull", [f"{h['load']:.0%}" for h in hulls]),
        row("hull with three threads [ms]", [f"{h['stages']['hull']['lasts_ms']:.1f}" for h in hulls]),
        row("capture to mesh, if nothing waits [ms]", [f"{p['latency_ms']:.1f}" for p in plans]),
        row("simulated: metaframes/s", [f"{p['simulation']['metaframes_per_s']:.1f}" for p in plans]),
        row("simulated: capture to mesh, median; p99 [ms]",
            [f"{p['simulation']['median_ms']:.1f}; {p['simulation']['p99_ms']:.1f}" for p in plans]),
        row("fits", ["yes" if p["fits"] else "no" for p in plans]),
    ]
    short, is_changed = machine.commit()
    changes = " and changes" if is_changed else ""
    origin = f"{machine.today():%Y-%m-%dT%H:%MZ}, commit {short}{changes}, predicted by the costs in deploy/costs.toml"
    with open(options.out, "w", encoding="utf-8") as file:
        json.dump({"origin": origin, "plans": plans}, file, indent=1)
    page_table.put_table(PAGE, "site_scale", lines, origin)
    print(f"kept in {options.out}")


if __name__ == "__main__":
    main()
