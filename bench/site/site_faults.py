"""Measures how a site on several hosts gets over faults of its hosts: see site_faults.sh."""

import argparse
import atexit
import glob
import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine  # noqa: E402
import page_table  # noqa: E402
from hosts_network import (  # noqa: E402
    NODES,
    SITE,
    Network,
    enter_namespaces,
    render_room,
    run,
    write_one_process,
)

PAGE = os.path.join(machine.ROOT, "docs", "measurements", "site_hosts.md")
NUM_CAMERAS = 16
PERIOD_S = 1.0 / 30.0
HOLD_S = 3.0  # how long a fault lasts
SETTLE_S = 3.0  # after a recovery
PATIENCE_S = 60.0
SLOW_MS = 160.0
WATCHERS = ["viewer", "world"]  # hosts that run site_watch and the monitor


class Lines:
    """What a program prints, with the time at which each line arrived."""

    def __init__(self, pipe, log):
        self.lines = []  # (seconds, text)
        self.changed = threading.Condition()
        threading.Thread(target=self._read, args=(pipe, log), daemon=True).start()

    def _read(self, pipe, log):
        for line in pipe:
            with self.changed:
                self.lines.append((time.monotonic(), line.rstrip("\n")))
                self.changed.notify_all()
            if log:
                log.write(line)
                log.flush()

    def since(self, begin):
        with self.changed:
            return [line for line in self.lines if line[0] >= begin]

    def wait(self, begin, get):
        """The first result of `get(line)` since `begin` that is not None."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            found = next((result for result in map(get, self.since(begin)) if result is not None), None)
            if found is not None:
                return found
            with self.changed:
                self.changed.wait(0.2)
        raise TimeoutError(f"nothing found in {PATIENCE_S} s")


class Site:
    """The programs of the site, and what they say."""

    def __init__(self, network, options, folder):
        self.network, self.options, self.folder = network, options, folder
        self.world = f"site-faults-{os.getpid()}"
        self.programs = {}
        self.says = {}
        self.log = open(os.path.join(folder, "programs.log"), "a", encoding="utf-8")
        self.offset = os.path.join(folder, "offset")

    def command(self, host):
        bus = ["--bus.world", self.world]
        if host == "viewer":
            return [f"{self.options.build}/bin/site_watch", *bus]
        common = ["--config", SITE, "--host", host, *bus]
        if host == "world":
            return [f"{self.options.build}/bin/monitor", "--json", *bus]
        if host == "hull":
            return [f"{self.options.build}/bin/site_node", *common]
        return [f"{self.options.build}/bin/camera_node", *common, "--simulation.cache", self.options.cache]

    def spawn(self, host, prefix=()):
        command = [*prefix, *self.command(host)]
        is_watch = host in WATCHERS
        errors = subprocess.DEVNULL if is_watch else subprocess.STDOUT
        return subprocess.Popen(self.network.command(host, command), stdout=subprocess.PIPE, stderr=errors, text=True)

    def start(self, host, prefix=()):
        """Returns when it was started [s]."""
        begin = time.monotonic()
        self.programs[host] = self.spawn(host, prefix)
        self.says[host] = Lines(self.programs[host].stdout, None if host in WATCHERS else self.log)
        atexit.register(self.programs[host].kill)
        return begin

    def signal(self, host, number):
        self.programs[host].send_signal(number)
        if number == signal.SIGKILL:
            self.programs[host].wait()

    def start_with_settable_clock(self, host):
        self.set_clock(0.0)
        library = glob.glob("/usr/lib/*/faketime/libfaketimeMT.so.1")
        if not library:
            sys.exit("install the package faketime")
        return self.start(
            host,
            [
                "/usr/bin/env",
                f"LD_PRELOAD={library[0]}",
                f"FAKETIME_TIMESTAMP_FILE={self.offset}",
                "FAKETIME_NO_CACHE=1",
                "FAKETIME_DONT_FAKE_MONOTONIC=1",
            ],
        )

    def set_clock(self, offset_s):
        with open(self.offset + ".new", "w", encoding="ascii") as file:
            file.write(f"{offset_s:+.6f}s\n")
        os.rename(self.offset + ".new", self.offset)

    def in_use(self, host, begin):
        """When the model part first used the host since `begin` [s]."""
        return self.says["hull"].wait(begin, lambda line: line[0] if f"host_in_use host={host} " in line[1] else None)

    def meshes(self, begin, end=float("inf")):
        """(seconds, cameras, spread of their times [s]) of each mesh."""
        found = []
        for _, text in self.says["viewer"].since(begin):
            words = text.split()
            if words[0] != "mesh":
                continue
            time_s = 1e-9 * int(words[1])
            if begin <= time_s < end:
                found.append((time_s, int(words[2]), 1e-9 * int(words[3])))
        return found

    def complete(self, begin):
        """When the first mesh of all cameras since `begin` arrived [s]."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            for time_s, cameras, _ in self.meshes(begin):
                if cameras == NUM_CAMERAS:
                    return time_s
            time.sleep(0.05)
        raise TimeoutError(f"no metaframe of all cameras in {PATIENCE_S} s")

    def own_start(self, host, begin):
        """How long the camera node that was started at `begin` needed to its first silhouette [s]."""

        def get(line):
            words = line[1].split()
            return float(words[3]) if words[0] == "node" and words[2] == host and float(words[3]) > 0.0 else None

        return self.says["viewer"].wait(begin, get)

    def end(self):
        for each in self.programs.values():
            each.send_signal(signal.SIGTERM)
        for each in self.programs.values():
            each.wait(timeout=30)


class Faults:
    """One method per fault: it does and ends the fault, and returns when it ended [s]."""

    def __init__(self, site):
        self.site, self.network = site, site.network

    def killed(self, host):
        self.site.signal(host, signal.SIGKILL)
        time.sleep(HOLD_S)
        return self.site.start(host)

    def killed_and_restarted_at_once(self, host):
        self.site.signal(host, signal.SIGKILL)
        return self.site.start(host)

    def stands_still(self, host):
        self.site.signal(host, signal.SIGSTOP)
        time.sleep(HOLD_S)
        self.site.signal(host, signal.SIGCONT)
        return time.monotonic()

    def cut_off(self, host):
        self.network.unplug(host)
        time.sleep(HOLD_S)
        self.network.plug(host)
        return time.monotonic()

    def slow(self, host):
        """All that leaves the host is late, long enough that its clock is no longer known, either."""
        run("ip", "link", "add", "slow-hub", "type", "veth", "peer", "slow-host")
        run("ip", "link", "set", "slow-hub", "master", "hub", "up")
        run("ip", "link", "set", "slow-host", "up")
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "slow_line.py")
        line = subprocess.Popen([sys.executable, script, f"to-{host}", "slow-host", str(SLOW_MS)], stdout=subprocess.PIPE, text=True)
        line.stdout.readline()
        run("ip", "link", "set", f"to-{host}", "nomaster")
        time.sleep(2.0 * HOLD_S)
        line.terminate()
        line.wait()
        self.network.plug(host)
        run("ip", "link", "del", "slow-hub")
        return time.monotonic()

    def clock_20_ms_ahead(self, host):
        return self._clock(0.020)

    def clock_one_period_behind(self, host):
        return self._clock(-PERIOD_S)

    def _clock(self, offset_s):
        self.site.set_clock(offset_s)
        time.sleep(HOLD_S)
        self.site.set_clock(0.0)
        return time.monotonic()

    def started_twice(self, host):
        second = self.site.spawn(host)
        output, _ = second.communicate(timeout=PATIENCE_S)
        if second.returncode != 2 or f"camera node 'hall.{host}'" not in output:
            raise RuntimeError(f"the second camera node was not refused, {second.returncode}: {output}")
        return time.monotonic()

    def model_part_killed(self, _):
        self.site.signal("hull", signal.SIGKILL)
        time.sleep(HOLD_S)
        return self.site.start("hull")


# name, text, host, camera node with a clock that can be set
FAULTS = [
    ("killed", "killed; restarted after 3 s", "north"),
    ("killed_and_restarted_at_once", "killed; restarted at once", "north"),
    ("stands_still", "stands still for 3 s", "east"),
    ("cut_off", "cut off for 3 s", "south"),
    ("slow", "160 ms late for 6 s", "east"),
    ("clock_20_ms_ahead", "clock 20 ms ahead for 3 s", "west"),
    ("clock_one_period_behind", "clock a period behind for 3 s", "west"),
    ("started_twice", "started twice", "south"),
    ("model_part_killed", "model part killed; restarted after 3 s", "hull"),
]


def measure(site, name, host):
    """Provokes one fault; its figures."""
    begin = time.monotonic()
    end = getattr(Faults(site), name)(host)
    in_use, own_start = end, None
    if name == "model_part_killed":
        in_use = max(site.in_use(node, end) for node in NODES)
    elif name != "started_twice":
        in_use = site.in_use(host, end)
    full = site.complete(max(end, in_use))
    if name.startswith("killed"):
        own_start = site.own_start(host, end)
    until_full = site.meshes(begin, full + 1e-6)
    times = [begin, *(mesh[0] for mesh in until_full)]
    expected = {"model_part_killed": None, "started_twice": False}.get(name, True)
    shown = any(f"host {host} is left out" in line for _, line in site.says["world"].since(begin))
    told = [line for _, line in site.says["hull"].since(begin) if "host_left_out" in line and f"host={host} " in line]
    time.sleep(SETTLE_S)
    after = site.meshes(full)
    return {
        "fault": name,
        "host": host,
        "lasted_s": end - begin,
        "in_use_ms": 1e3 * (in_use - end),
        "all_cameras_ms": 1e3 * (full - end),
        "own_start_ms": None if own_start is None else 1e3 * own_start,
        "longest_gap_ms": 1e3 * max(b - a for a, b in zip(times, times[1:])),
        "metaframes_per_s": max(len(until_full) - 1, 0) / (full - begin),
        "fewest_cameras": min((mesh[1] for mesh in until_full), default=0),
        "mixed": sum(mesh[2] > PERIOD_S / 2 for mesh in [*until_full, *after]),
        "named_in_log": None if expected is None else bool(told) == expected,
        # the site reports once a second: a shorter absence may not be seen
        "named_in_monitor": None if expected is None or name == "killed_and_restarted_at_once" else shown == expected,
        "told": [re.sub(r"^.*?(?=host_left_out)", "", line) for line in told],
    }


def text_of(figures):
    own = "" if figures["own_start_ms"] is None else f" (own start {figures['own_start_ms']:.0f})"
    return (
        f"{figures['fault']}: in use after {figures['in_use_ms']:.0f} ms{own}, all cameras after {figures['all_cameras_ms']:.0f} ms; "
        f"longest gap {figures['longest_gap_ms']:.0f} ms, {figures['metaframes_per_s']:.1f} metaframes/s meanwhile, "
        f"mixed {figures['mixed']}, named in log {figures['named_in_log']}, monitor {figures['named_in_monitor']}"
    )


def row_of(text, runs):
    def spread(key, form="{:.0f}", worst=max):
        values = [figures[key] for figures in runs]
        return form.format(statistics.median(values)) + ("; " + form.format(worst(values)) if len(values) > 1 else "")

    def all_of(key):
        values = [figures[key] for figures in runs if figures[key] is not None]
        return "" if not values else "yes" if all(values) else f"{sum(values)} of {len(values)}"

    is_restart = runs[0]["own_start_ms"] is not None
    is_duplicate = runs[0]["fault"] == "started_twice"
    named = ["refused"] * 2 if is_duplicate else [all_of("named_in_log"), all_of("named_in_monitor")]
    cells = [
        text,
        "" if is_duplicate else spread("in_use_ms"),
        "" if is_duplicate else spread("all_cameras_ms"),
        spread("own_start_ms") if is_restart else "",
        spread("longest_gap_ms"),
        spread("metaframes_per_s", "{:.1f}", min),
        str(sum(figures["mixed"] for figures in runs)),
        *named,
    ]
    return "| " + " | ".join(cells) + " |"


def write_page(runs, origin):
    header = [
        "a camera node is",
        "in use again [ms]",
        "all cameras again [ms]",
        "of that its own start [ms]",
        "longest gap [ms]",
        "metaframes/s meanwhile",
        "metaframes of two instants",
        "named in log",
        "named in monitor",
    ]
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    for name, text, _ in FAULTS:
        of_fault = [figures for figures in runs if figures["fault"] == name]
        if of_fault:
            lines.append(row_of(text, of_fault))
    page_table.put_table(PAGE, "site_faults", lines, origin)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True)
    parser.add_argument("--runs", type=int, required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--only", help="one fault, without a result", choices=[name for name, _, _ in FAULTS])
    parser.add_argument("--inside", action="store_true", help="in namespaces of its own")
    options = parser.parse_args()
    options.build = os.path.abspath(options.build)
    options.cache = os.path.abspath(".cache/rooms")
    if not options.inside:
        os.environ["ATRIUM_SCORE"] = json.dumps(machine.score(options.build))
        _, used = machine.wait_until_idle(0.0)
        os.environ["ATRIUM_OTHERS"] = str(used["others"])
        enter_namespaces()
    score = json.loads(os.environ["ATRIUM_SCORE"])
    others = float(os.environ["ATRIUM_OTHERS"])
    runs = []
    with tempfile.TemporaryDirectory() as folder:
        network = Network()
        render_room(options.build, options.cache, write_one_process(folder))
        site = Site(network, options, folder)
        try:
            for host in WATCHERS:
                site.start(host)
            begin = site.start("hull")
            for node in NODES:
                if node == "west":
                    site.start_with_settable_clock(node)
                else:
                    site.start(node)
            for node in NODES:
                site.in_use(node, begin)
            site.complete(begin)
            time.sleep(SETTLE_S)
            before = machine.CpuTimes.now()
            for _ in range(options.runs):
                for name, _, host in FAULTS:
                    if options.only in (None, name):
                        runs.append(measure(site, name, host))
                        print(text_of(runs[-1]), flush=True)
            busy = machine.shares(before, machine.CpuTimes.now())["others"]
            site.end()
        except Exception:
            with open(os.path.join(folder, "programs.log"), encoding="utf-8") as log:
                sys.stderr.write("".join(log.readlines()[-60:]))
            raise
    if options.only:
        return
    short, is_changed = machine.commit()
    origin = (
        f"{machine.today():%Y-%m-%dT%H:%MZ}, commit {short}{' and changes' if is_changed else ''}, {machine.name()}, "
        f"{machine.num_cores()} cores, machine score {score['one_core']['score']:.1f}, busy {busy:.0%}, others {others:.0%} "
        f"before; median; worst of {options.runs} runs"
    )
    with open(options.out, "w", encoding="utf-8") as file:
        json.dump({"origin": origin, "runs": runs}, file, indent=1)
    write_page(runs, origin)
    print(f"kept in {options.out}")


if __name__ == "__main__":
    main()
