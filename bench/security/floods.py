#!/usr/bin/env python3
"""Floods a closed world from outside and measures what its members lose: a site, a world server and a listener with keys on this host,
one minute without a flood, one under garbage on the discovery ports, one under handshakes of strangers, one under those of strangers
whose leases never end, one under replayed datagrams. Keeps the figures with date, commit and machine in
bench/results/DATE-MACHINE-security-floods.csv and renews the table of docs/measurements/security.md. Needs the right to listen on the
network (root).

usage: floods.py [BUILD] [SECONDS]
"""

import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine
import tables

DOMAIN = 77
GARBAGE_PER_S = 100000
HANDSHAKES_PER_S = 1000  # at each port
NUM_PORTS = 3  # of the site, the world server and the listener
REPLAYED_PER_S = 5000


def fail(text):
    print(f"floods: {text}", file=sys.stderr)
    sys.exit(1)


class World:
    """The programs of a closed world, in a folder of their own."""

    def __init__(self, build, folder):
        self.bin = os.path.join(os.path.abspath(build), "bin")
        self.folder = folder
        self.running = []
        self.keys("init", "playroom")
        for words in (("world",), ("site", "alice"), ("monitor", "mona")):
            self.keys("add", *words)
            name = words[-1] if len(words) > 1 else "playroom"
            self.keys("export", name, "-o", self.path(name + ".bundle"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def keys(self, *words, store="playroom.keys"):
        subprocess.run([os.path.join(self.bin, "keys"), *words, "--keys", self.path(store)], check=True, stdout=subprocess.DEVNULL)

    def start(self, name, program, *words):
        log = open(self.path(name + ".log"), "w", encoding="utf-8")
        process = subprocess.Popen([os.path.join(self.bin, program), *words], stdout=log, stderr=subprocess.STDOUT, cwd=machine.ROOT)
        self.running.append(process)
        return process

    def text(self, name):
        with open(self.path(name + ".log"), encoding="utf-8", errors="replace") as file:
            return file.read()

    def wait_for(self, name, words, seconds=60):
        end = time.monotonic() + seconds
        while words not in self.text(name):
            if time.monotonic() > end:
                fail(f"no '{words}' from {name}:\n{self.text(name)}")
            time.sleep(0.05)

    def end(self, process):
        process.send_signal(signal.SIGTERM)
        process.wait(30)
        self.running.remove(process)

    def end_all(self):
        for process in list(self.running):
            self.end(process)


def usage(process):
    """Processor time [s] and resident memory [MB]."""
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        words = file.read().rsplit(")", 1)[1].split()
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        resident = int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1))
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK"), resident / 1000


def sniff(seconds, wanted, most):
    """UDP payloads on loopback that `wanted` accepts."""
    sniffer = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(0x0800))
    sniffer.bind(("lo", 0))
    sniffer.settimeout(0.2)
    found = []
    end = time.monotonic() + seconds
    while time.monotonic() < end and len(found) < most:
        try:
            packet = sniffer.recv(65536)
        except TimeoutError:
            continue
        if packet[9] == 17 and wanted(packet[28:]):
            found.append(packet[28:])
    return found


def endless(announcement):
    """The same announcement with a lease that never ends (PID_PARTICIPANT_LEASE_DURATION)."""
    head, lease, rest = announcement.partition(b"\x02\x00\x08\x00")
    if not lease:
        fail("an announcement without a lease")
    return head + lease + b"\xff\xff\xff\x7f\xff\xff\xff\xff" + rest[8:]


def write_datagrams(path, datagrams):
    with open(path, "wb") as file:
        for datagram in datagrams:
            file.write(struct.pack("<I", len(datagram)) + datagram)


def measure(world, honest, name, seconds, flood):
    """One row: a listener joins, then the flood begins, and counts while it lasts."""
    listener = world.start(name, "stream_watch", "--security", world.path("mona.bundle"), "--bus.domain", str(DOMAIN), "--ignore", "2")
    world.wait_for(name, "first alice")
    time.sleep(2)
    flooder = world.start(name + "-flood", "security_flood", "--domain", str(DOMAIN), "--programs", str(NUM_PORTS), *flood) if flood else None
    before = [usage(process) for process in honest]
    most_mb = 0.0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        time.sleep(0.5)
        most_mb = max(most_mb, sum(usage(process)[1] for process in honest))
    after = [usage(process) for process in honest]
    sent = 0
    if flooder:
        world.end(flooder)
        sent = int(re.search(r"sent (\d+)", world.text(name + "-flood")).group(1))
    time.sleep(1)
    world.end(listener)
    match = re.search(r"site alice received (\d+) missing (\d+) lost \d+ longest_gap_ms (\d+) median_ms ([\d.]+)", world.text(name))
    if not match:
        fail(f"the listener heard nothing:\n{world.text(name)}")
    received, missing = int(match.group(1)), int(match.group(2))
    return {"flood": name, "seconds": seconds, "sent_per_s": round(sent / seconds), "received": received, "missing": missing,
            "share": round(received / (received + missing), 5), "longest_gap_ms": int(match.group(3)), "median_ms": float(match.group(4)),
            "site_percent": round(100 * (after[0][0] - before[0][0]) / seconds, 1),
            "world_percent": round(100 * (after[1][0] - before[1][0]) / seconds, 1),
            "mb_before": round(sum(use[1] for use in before), 1), "mb_most": round(most_mb, 1),
            "mb_after": round(sum(usage(process)[1] for process in honest), 1)}


def run(build, seconds):
    with tempfile.TemporaryDirectory(prefix="floods-") as folder:
        world = World(build, folder)
        try:
            domain = ("--bus.domain", str(DOMAIN))
            server = world.start("world", "world_server", "--config", "deploy/worlds/demo.toml", "--security", world.path("playroom.bundle"), *domain)
            site = world.start("alice", "site_node", "--config", "deploy/sites/alice.toml", "--security", world.path("alice.bundle"), *domain)
            world.wait_for("world", "site_arrived site=alice", 300)
            honest = (site, server)
            rows = [measure(world, honest, "none", seconds, None)]
            rows.append(measure(world, honest, "garbage", seconds, ("--rate", str(GARBAGE_PER_S))))
            # announcements of a program with keys of another store
            world.keys("init", "playroom", store="strangers.keys")
            world.keys("add", "viewer", "stranger", store="strangers.keys")
            world.keys("export", "stranger", "-o", world.path("stranger.bundle"), store="strangers.keys")
            stranger = world.start("stranger", "security_attacker", "--domain", str(DOMAIN), "--bundle", world.path("stranger.bundle"),
                                   "--read", "playroom/site/alice")
            announcements = sniff(20, lambda data: b"DDS:Auth:PKI-DH" in data and b"security_attacker" in data, 8)
            world.end(stranger)
            write_datagrams(world.path("announcements"), announcements)
            rows.append(measure(world, honest, "handshakes", seconds,
                                ("--datagrams", world.path("announcements"), "--new-prefix", "--rate", str(NUM_PORTS * HANDSHAKES_PER_S))))
            write_datagrams(world.path("endless"), [endless(one) for one in announcements])
            rows.append(measure(world, honest, "endless", seconds,
                                ("--datagrams", world.path("endless"), "--new-prefix", "--rate", str(NUM_PORTS * HANDSHAKES_PER_S))))
            write_datagrams(world.path("replayed"), sniff(2, lambda data: True, 20000))
            rows.append(measure(world, honest, "replay", seconds, ("--datagrams", world.path("replayed"), "--rate", str(REPLAYED_PER_S))))
            rows.append(measure(world, honest, "after", min(seconds, 20), None))
        finally:
            world.end_all()
    return rows


def main():
    if len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return
    build = sys.argv[1] if len(sys.argv) > 1 else "build"
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 60
    rows = run(build, seconds)
    result = os.path.join(machine.ROOT, "bench", "results", f"{machine.today():%Y-%m-%d}-{machine.file_part(machine.name())}-security-floods.csv")
    with open(result, "w", encoding="utf-8") as file:
        print(f"# {machine.origin_line(machine.origin(build))}", file=file)
        print(",".join(rows[0]), file=file)
        for row in rows:
            print(",".join(str(value) for value in row.values()), file=file)
    tables.renew_floods(result, os.path.join(machine.ROOT, "docs", "measurements", "security.md"))
    print(result)


if __name__ == "__main__":
    main()
