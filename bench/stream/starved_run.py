#!/usr/bin/env python3
"""Runs a site, a world server and a viewer in three network namespaces on one bridge. The viewer's host lacks processor time.

usage: starved_run.py BUILD STARVED LIMIT NETWORK SECONDS SEED CACHE    one row of CSV; `starved_run.py head`: the column names

STARVED: none; quota (a control group gives 0.3 core); loops (three busy loops on the viewer's core, which pause at times); freezes
(it stands still for 0.5 s every 2 to 5 s). SEED decides their times. LIMIT: Mbit/s towards the viewer, from 5 s after the start of the
measurement; 0: none. NETWORK: lan or wan. With two or more cores, the site and the world server get the first one, and the viewer the others. Needs root, or user namespaces (not enough for `quota`), and tc with tbf.
"""

import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

HEADS = "starved,limit_mbit_per_s,network,seed,seconds,captured,dropped_for_rate,levels,last_level,found_s,mbit_per_s,share_of_limit,dropped_packets,pictures_per_s"
HOSTS = ("site", "world", "viewer")
LIMIT_AFTER_S = 5.0
PATIENCE_S = 90.0


def run(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)


class Bridge:
    """Three hosts, each a namespace that lives as long as its process."""

    def __init__(self):
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "hub", "type", "bridge")
        run("ip", "link", "set", "hub", "up")
        self.holders = {}
        for number, host in enumerate(HOSTS, start=1):
            holder = subprocess.Popen(["unshare", "-n", "sleep", "infinity"])
            self.holders[host] = holder
            while os.readlink(f"/proc/{holder.pid}/ns/net") == os.readlink("/proc/self/ns/net"):
                time.sleep(0.01)
            run("ip", "link", "add", host, "type", "veth", "peer", "name", "eth0", "netns", str(holder.pid))
            run("ip", "link", "set", host, "master", "hub", "up")
            for words in (("ip", "link", "set", "lo", "up"), ("ip", "address", "add", f"10.78.0.{number}/24", "dev", "eth0"),
                          ("ip", "link", "set", "eth0", "up"), ("ip", "route", "add", "default", "dev", "eth0")):
                run(*self.inside(host), *words)

    def inside(self, host):
        return ("nsenter", "-t", str(self.holders[host].pid), "-n")

    def limit(self, mbit_per_s):
        run("tc", "qdisc", "add", "dev", "viewer", "root", "tbf", "rate", f"{mbit_per_s}mbit", "burst", "16kb", "latency", "100ms")

    def dropped(self):
        text = subprocess.run(["tc", "-s", "qdisc", "show", "dev", "viewer"], check=True, capture_output=True, text=True).stdout
        found = re.search(r"qdisc tbf.*?dropped (\d+)", text, re.S)
        return int(found.group(1)) if found else 0

    @staticmethod
    def bytes_from_site():
        with open("/proc/self/net/dev", encoding="ascii") as file:
            return int(re.search(r"^\s*site:\s*(\d+)", file.read(), re.M).group(1))

    def close(self):
        for holder in self.holders.values():
            holder.kill()
            holder.wait()


class Program:
    def __init__(self, bridge, host, words, cores, network):
        self.log = tempfile.TemporaryFile("w+")
        words = [*words, "--network", network, "--interface", "eth0"]
        if network == "wan":
            words += ["--peers", ",".join(f"10.78.0.{number}" for number in range(1, len(HOSTS) + 1))]
        self.process = subprocess.Popen([*bridge.inside(host), *words], stdout=self.log, stderr=subprocess.STDOUT,
                                        preexec_fn=lambda: os.sched_setaffinity(0, cores))

    def text(self):
        self.log.seek(0)
        return self.log.read()

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(30)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        return self.text()


class Quota:
    """A control group of 0.3 core."""

    def __init__(self):
        v1 = "/sys/fs/cgroup/cpu"
        self.is_v1 = os.path.exists(f"{v1}/cpu.cfs_quota_us")
        self.folder = f"{v1 if self.is_v1 else '/sys/fs/cgroup'}/atrium_starved_{os.getpid()}"
        if not self.is_v1:
            self.write("/sys/fs/cgroup/cgroup.subtree_control", "+cpu")
        os.mkdir(self.folder)
        if self.is_v1:
            self.write(f"{self.folder}/cpu.cfs_period_us", "100000")
            self.write(f"{self.folder}/cpu.cfs_quota_us", "30000")
        else:
            self.write(f"{self.folder}/cpu.max", "30000 100000")

    @staticmethod
    def write(path, text):
        with open(path, "w", encoding="ascii") as file:
            file.write(text)

    def add(self, pid):
        self.write(f"{self.folder}/cgroup.procs", str(pid))

    def close(self):
        parent = os.path.dirname(self.folder)
        with open(f"{self.folder}/cgroup.procs", encoding="ascii") as file:
            for pid in file.read().split():
                self.write(f"{parent}/cgroup.procs", pid)
        os.rmdir(self.folder)


class Starvation:
    def __init__(self, kind, viewer, cores, seed):
        self.random = random.Random(seed)
        self.viewer = viewer
        self.ended = threading.Event()
        self.threads = []
        self.loops = []
        self.quota = None
        if kind == "quota":
            time.sleep(self.random.uniform(0.0, 0.1))  # start of its periods
            self.quota = Quota()
            self.quota.add(viewer.pid)
        elif kind == "loops":
            for _ in range(3):
                self.loops.append(subprocess.Popen([sys.executable, "-c", "while True: pass"],
                                                   preexec_fn=lambda: os.sched_setaffinity(0, cores)))
                self.start(self.rest, self.loops[-1], random.Random(self.random.random()))
        elif kind == "freezes":
            self.start(self.freeze)

    def start(self, body, *arguments):
        self.threads.append(threading.Thread(target=body, args=arguments))
        self.threads[-1].start()

    def rest(self, loop, rng):
        while not self.ended.wait(rng.uniform(0.5, 3.0)):
            loop.send_signal(signal.SIGSTOP)
            self.ended.wait(rng.uniform(0.0, 0.3))
            loop.send_signal(signal.SIGCONT)

    def freeze(self):
        while not self.ended.wait(self.random.uniform(2.0, 5.0)):
            self.viewer.send_signal(signal.SIGSTOP)
            self.ended.wait(0.5)
            self.viewer.send_signal(signal.SIGCONT)

    def close(self):
        self.ended.set()
        for thread in self.threads:
            thread.join()
        for loop in self.loops:
            loop.kill()
            loop.wait()
        if self.quota:
            self.quota.close()


def wait_for(what, program, seconds=PATIENCE_S):
    end = time.monotonic() + seconds
    while not what():
        if time.monotonic() > end or program.process.poll() is not None:
            sys.exit(f"not in time: {program.text()[-2000:]}")
        time.sleep(0.1)


def is_streaming():
    before = Bridge.bytes_from_site()
    time.sleep(1.0)
    return Bridge.bytes_from_site() - before > 100_000


def found_after(samples, limited_at, bit_per_s):
    """Time from which on the site never sends more than 1.15 of the limit in any second [s]."""
    found = 0.0
    for first, (begin, sent) in enumerate(samples):
        if begin < limited_at:
            continue
        after = next(((t, b) for t, b in samples[first:] if t >= begin + 1.0), None)
        if after and 8.0 * (after[1] - sent) / (after[0] - begin) > 1.15 * bit_per_s:
            found = begin - limited_at
    return found


def measure(build, kind, limit, network, seconds, seed, cache):
    cores = sorted(os.sched_getaffinity(0))
    first, others = ({cores[0]}, set(cores[1:])) if len(cores) > 1 else (set(cores), set(cores))
    bridge = Bridge()
    programs = []
    starvation = None
    try:
        def start(host, *words):
            programs.append(Program(bridge, host, words, others if host == "viewer" else first, network))
            return programs[-1]

        start("world", f"{build}/bin/world_server")
        viewer = start("viewer", f"{build}/bin/viewer", "--view.context", "osmesa", "--view.name", "starved")
        site = start("site", f"{build}/bin/site_node", "--config", "deploy/sites/alice.toml", "--simulation.loop_s", "1",
                     "--simulation.cache", cache, "--codec.jpeg_quality", "100", "--codec.texture_resolution", "full")
        wait_for(is_streaming, site)
        time.sleep(3.0)
        levels_before = site.text().count("stream level ")
        starvation = Starvation(kind, viewer.process, others, seed)
        began = time.monotonic()
        limited_at = None
        samples = []
        while time.monotonic() - began < seconds:
            if limit > 0.0 and limited_at is None and time.monotonic() - began >= LIMIT_AFTER_S:
                bridge.limit(limit)
                limited_at = time.monotonic()
            samples.append((time.monotonic(), Bridge.bytes_from_site()))
            time.sleep(0.05)
        dropped = bridge.dropped()
        starvation.close()
        starvation = None
        site_text = site.stop()
        viewer_text = viewer.stop()
    finally:
        if starvation:
            starvation.close()
        for program in programs:
            program.stop()
        bridge.close()
    stopped = re.search(r"stopped captured=(\d+) .*?rate=(\d+)", site_text)
    if not stopped:
        sys.exit(f"the site failed: {site_text[-2000:]}")
    levels = re.findall(r"stream level (.*)", site_text)
    pictures = re.search(r"viewer_stopped frames=\d+ frames_per_s=([\d.]+)", viewer_text)
    if os.environ.get("KEEP_LOGS"):
        for name, text in (("site", site_text), ("viewer", viewer_text)):
            with open(f"{os.environ['KEEP_LOGS']}/{kind}-{limit:g}-{network}-{seed}-{name}.log", "w", encoding="utf-8") as file:
                file.write(text)
    settled = [s for s in samples if limited_at is None or s[0] > limited_at + 3.0]
    mbit = 8e-6 * (settled[-1][1] - settled[0][1]) / (settled[-1][0] - settled[0][0])
    last = re.sub(r" reason=.*", "", levels[-1]).replace(",", ";") if levels else "best"
    found = f"{found_after(samples, limited_at, 1e6 * limit):.2f}" if limited_at else ""
    share = f"{mbit / limit:.2f}" if limited_at else ""
    picture_rate = pictures.group(1) if pictures else ""
    print(f"{kind},{limit:g},{network},{seed},{seconds:g},{stopped.group(1)},{stopped.group(2)},{len(levels) - levels_before},{last},{found},{mbit:.2f},"
          f"{share},{dropped},{picture_rate}", flush=True)


def main(words):
    if words == ["head"]:
        print(HEADS)
        return
    if len(words) != 7:
        sys.exit(__doc__)
    if os.environ.get("ATRIUM_OWN_NETWORK") != "1":
        os.environ["ATRIUM_OWN_NETWORK"] = "1"
        flags = "-n" if os.geteuid() == 0 else "-Urn"
        os.execvp("unshare", ["unshare", flags, sys.executable, os.path.abspath(__file__), *words])
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # otherwise programs would stay behind
    build, kind, limit, network, seconds, seed, cache = words
    measure(os.path.abspath(build), kind, float(limit), network, float(seconds), int(seed), os.path.abspath(cache))


if __name__ == "__main__":
    main(sys.argv[1:])
