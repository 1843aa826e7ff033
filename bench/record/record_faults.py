#!/usr/bin/env python3
"""Measures what a recorder loses to faults: see record_faults.sh. tests/integration runs it, too, with fewer kills."""

import argparse
import collections
import glob
import json
import os
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "bench"))
sys.path.insert(0, os.path.join(ROOT, "tests", "support", "mcap"))
import machine  # noqa: E402
import read_mcap  # noqa: E402

WORLD = f"record-faults-{os.getpid()}"
# Promised: at most the last second of samples. On top of it, a wait for a processor on a machine under load.
PROMISED_LOSS_S = 1.0
FAKETIME = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1"


class Skipped(Exception):
    """This machine does not allow it; says why."""


class Bench:
    def __init__(self, programs, folder):
        self.programs, self.folder, self.running = programs, folder, []

    def start(self, command, log, env=None, before=()):
        out = open(os.path.join(self.folder, log), "w", encoding="utf-8")
        process = subprocess.Popen([*before, os.path.join(self.programs, command[0]), *command[1:]], stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=subprocess.STDOUT, cwd=ROOT, env=os.environ | (env or {}))
        process.log = out.name
        self.running.append(process)
        return process

    def stop(self, process, sig=signal.SIGINT):
        if process.poll() is None:
            process.send_signal(sig)
        process.wait(timeout=60)
        self.running.remove(process)
        return process.returncode

    def stop_all(self):
        for process in list(self.running):
            self.stop(process, signal.SIGKILL)

    def recorder(self, file, *options, **how):
        return self.start(["record", "-o", file, "--world", WORLD, *options], os.path.basename(file) + ".log", **how)

    def path(self, name):
        return os.path.join(self.folder, name)

    def info(self, file):
        done = subprocess.run([os.path.join(self.programs, "play"), file, "--info", "--json"], capture_output=True, text=True, check=False)
        return json.loads(done.stdout) if done.returncode == 0 else None


def text_of(file):
    with open(file, encoding="utf-8") as stream:
        return stream.read()


def wait_until(condition, what, limit_s=60):
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"never came: {what}")
        time.sleep(0.05)


def read(file):
    with open(file, "rb") as stream:
        return read_mcap.Mcap(stream.read())


def record_two_sites(bench, file):
    """The source of all samples: two sites and a world server, recorded once."""
    programs = [bench.start(["site_node", "--config", f"deploy/sites/{site}.toml", "--world", WORLD], f"{site}.log")
                for site in ("alice", "bob")]
    programs.append(bench.start(["world_server", "--config", "deploy/worlds/demo.toml", "--world", WORLD], "world.log"))
    recorder = bench.recorder(file)
    wait_until(lambda: {"alice", "bob"} <= set(re.findall(r"site=(\w+)", text_of(recorder.log))), "both sites")
    time.sleep(8)
    bench.stop(recorder)
    for program in programs:
        bench.stop(program)


def samples_of(mcap):
    return [message for message in mcap.messages if message.topic != "recorder"]


def check_unbroken(mcap):
    """No message is missing in front of the last of each channel."""
    sequences = collections.defaultdict(list)
    for message in mcap.messages:
        sequences[message.channel].append(message.sequence)
    return all(numbers == list(range(len(numbers))) for numbers in sequences.values())


def kill_once(bench, number, chance):
    file = bench.path(f"kill{number}.mcap")
    recorder = bench.recorder(file)
    wait_until(lambda: os.path.exists(file) and os.path.getsize(file) > 500_000, "a recording that grows")
    time.sleep(chance.uniform(0.0, 3.0))
    killed_ns = time.time_ns()
    recorder.send_signal(signal.SIGKILL)
    bench.stop(recorder)
    info = bench.info(file)
    if info is None or not info["fault"]:
        sys.exit(f"{file}: a killed recorder's file must open and have a fault: {info}")
    repaired = subprocess.run([os.path.join(bench.programs, "play"), file, "--repair"], capture_output=True, text=True, check=False)
    after = bench.info(file)
    mcap = read(file)  # checks everything, or raises
    samples = samples_of(mcap)
    os.remove(file)
    return {"loss_s": (killed_ns - samples[-1].log_time) * 1e-9, "samples": len(samples), "fault": info["fault"],
            "damaged_chunks": info["num_damaged_chunks"],
            "ok": repaired.returncode == 0 and after["fault"] == "" and after["num_samples"] == info["num_samples"]
            and check_unbroken(mcap)}


def kills(bench, num):
    chance = random.Random(22)
    runs = [kill_once(bench, number, chance) for number in range(num)]
    return {"runs": runs, "worst_loss_s": max(run["loss_s"] for run in runs),
            "ok": all(run["ok"] and run["damaged_chunks"] == 0 for run in runs)}


def picture_times_of(path):
    """Capture times of the whole pictures of a room's frames.raw: docs/recording_rooms.md."""
    times = []
    with open(path, "rb") as file:
        file.seek(struct.unpack_from("<I", file.read(48), 28)[0], os.SEEK_CUR)
        while len(head := file.read(40)) == 40:
            if head[:8] != b"PICTURE\n":
                sys.exit(f"{path}: no picture where one should begin")
            size, time_ns = struct.unpack_from("<Iq", head, 12)
            if len(file.read(size)) < size:
                break
            times.append(time_ns)
    return times


def kill_room_once(bench, number, chance):
    folder = bench.path(f"room{number}")
    site = bench.start(["site_node", "--config", "deploy/sites/alice.toml", "--world", f"{WORLD}-room", "--record", folder],
                       f"room{number}.log")
    files = lambda: glob.glob(os.path.join(folder, "*", "frames.raw"))  # noqa: E731
    wait_until(lambda: files() and all(os.path.getsize(file) > 200_000 for file in files()), "a room's recording that grows")
    time.sleep(chance.uniform(0.0, 2.0))
    killed_ns = time.time_ns()
    bench.stop(site, signal.SIGKILL)
    times = {file: picture_times_of(file) for file in files()}
    replay = subprocess.run([os.path.join(bench.programs, "site_node"), "--site.name", "room", "--world", f"{WORLD}-room", "--rate", "0",
                             "--recording", folder], capture_output=True, text=True, check=False, cwd=ROOT, timeout=120)
    shutil.rmtree(folder)
    return {"loss_s": max(killed_ns - each[-1] for each in times.values()) * 1e-9, "pictures": sum(map(len, times.values())),
            "ok": replay.returncode == 0 and all(each == sorted(each) for each in times.values())}


def room_kills(bench, num):
    chance = random.Random(23)
    runs = [kill_room_once(bench, number, chance) for number in range(num)]
    return {"runs": runs, "least_loss_s": min(run["loss_s"] for run in runs), "worst_loss_s": max(run["loss_s"] for run in runs),
            "ok": all(run["ok"] for run in runs)}


def full_disk(bench):
    if subprocess.run(["unshare", "-rm", "true"], capture_output=True, check=False).returncode != 0:
        raise Skipped("no mount namespaces")
    disk, copy = bench.path("full"), bench.path("full.mcap")
    os.mkdir(disk)
    # The copy leaves the namespace by standard output.
    script = (f"mount -t tmpfs -o size=8m none {disk} && {bench.programs}/record -o {disk}/a.mcap --world {WORLD} --spare_disk_mb 2 "
              f"> {bench.path('full.log')} 2>&1; code=$?; cat {disk}/a.mcap > {copy}; exit $code")
    code = subprocess.run(["unshare", "-rm", "sh", "-c", script], check=False, timeout=120, stdin=subprocess.DEVNULL).returncode
    mcap = read(copy)
    log = text_of(bench.path("full.log"))
    notes = [json.loads(message.data) for message in mcap.messages if message.topic == "recorder"]
    return {"exit": code, "mb": os.path.getsize(copy) / 1e6, "samples": len(samples_of(mcap)), "dropped": notes[-1]["num_dropped"],
            "message": (re.findall(r"the disk is full[^\n]*|No space left[^\n]*", log) or [""])[-1],
            "ok": code == 3 and check_unbroken(mcap) and "disk is full" in log and bench.info(copy)["fault"] == ""}


def standing_disk(bench):
    """A disk that takes nothing for five seconds: more than its buffer of 1 MB holds."""
    image, disk = bench.path("disk.img"), bench.path("standing")
    os.mkdir(disk)
    with open(image, "wb") as stream:
        stream.truncate(200_000_000)
    try:
        for command in (["mkfs.ext4", "-q", image], ["mount", "-o", "loop", image, disk]):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise Skipped(f"no loop devices: {done.stderr.strip() or command[0]}")
    except FileNotFoundError as error:
        raise Skipped(f"no loop devices: {error}") from error
    try:
        file = os.path.join(disk, "a.mcap")
        recorder = bench.start(["record", "-o", file, "--world", WORLD, "--buffer_mb", "1", "--spare_disk_mb", "1"], "standing.log")
        wait_until(lambda: os.path.exists(file) and os.path.getsize(file) > 500_000, "a recording that grows")
        subprocess.run(["fsfreeze", "-f", disk], check=True)
        try:
            time.sleep(5.0)
        finally:
            subprocess.run(["fsfreeze", "-u", disk], check=True)
        time.sleep(3.0)
        code = bench.stop(recorder)
        mcap = read(file)
    finally:
        subprocess.run(["umount", disk], check=False)
    notes = [json.loads(message.data) for message in mcap.messages if message.topic == "recorder"]
    log = text_of(bench.path("standing.log"))
    in_log = int((re.findall(r"dropped=(\d+) rejected", log) or ["0"])[-1])
    dropped = notes[-1]["num_dropped"]
    return {"exit": code, "dropped": dropped, "dropped_by_topic": notes[-1]["dropped"], "dropped_in_log": in_log,
            "warned": "disk_too_slow" in log,
            "ok": code == 0 and dropped > 0 and dropped == in_log and "disk_too_slow" in log
            and sum(notes[-1]["dropped"].values()) == dropped and check_unbroken(mcap)}


def clock_set_back(bench):
    if not os.path.exists(FAKETIME):
        raise Skipped("no faketime")
    file, clock = bench.path("clock.mcap"), bench.path("clock")
    with open(clock, "w", encoding="ascii") as stream:
        stream.write("+0\n")
    recorder = bench.recorder(file, env={"LD_PRELOAD": FAKETIME, "FAKETIME_TIMESTAMP_FILE": clock, "FAKETIME_NO_CACHE": "1",
                                         "FAKETIME_DONT_FAKE_MONOTONIC": "1"})
    wait_until(lambda: os.path.exists(file) and os.path.getsize(file) > 500_000, "a recording that grows")
    begin = time.monotonic()
    with open(clock + ".new", "w", encoding="ascii") as stream:
        stream.write("-3600\n")
    os.replace(clock + ".new", clock)
    time.sleep(4.0)
    bench.stop(recorder)
    times = sorted(message.log_time for message in samples_of(read(file)))
    mcap = read(file)
    in_order = [message.log_time for message in mcap.messages if message.topic == "SceneState"]
    gaps = [(b - a) * 1e-9 for a, b in zip(times, times[1:])]
    return {"duration_s": (times[-1] - times[0]) * 1e-9, "longest_gap_s": max(gaps), "at_least_s": 4.0, "measured_s": time.monotonic() - begin,
            "ok": 4.0 <= (times[-1] - times[0]) * 1e-9 < 600.0 and in_order == sorted(in_order) and max(gaps) < 60.0}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", required=True, help="folder of the programs")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--source", help="a recording of two sites; without it, one is made")
    parser.add_argument("--out", help="file for the figures, JSON")
    arguments = parser.parse_args()
    results = {"promised_loss_s": PROMISED_LOSS_S}
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(os.path.abspath(arguments.bin), folder)
        try:
            source = arguments.source or bench.path("source.mcap")
            if not arguments.source:
                record_two_sites(bench, source)
            # behind the start of the sites: while nothing is sent, nothing is lost
            bench.start(["play", source, "--loop", "--from", "3", "--world", WORLD], "play.log")
            time.sleep(2)
            for name, measure in (("kill", lambda: kills(bench, arguments.kills)), ("full_disk", lambda: full_disk(bench)),
                                  ("room_kill", lambda: room_kills(bench, arguments.kills)), ("standing_disk", lambda: standing_disk(bench)), ("clock_set_back", lambda: clock_set_back(bench))):
                try:
                    results[name] = measure()
                except Skipped as reason:
                    results[name] = {"skipped": str(reason), "ok": True}
                print(name, json.dumps({key: value for key, value in results[name].items() if key != "runs"}), flush=True)
        finally:
            bench.stop_all()
            shutil.rmtree(os.path.join(folder, "full"), ignore_errors=True)
    if arguments.out:
        results["origin"] = machine.origin(os.path.dirname(bench.programs))
        with open(arguments.out, "w", encoding="utf-8") as stream:
            json.dump(results, stream, indent=1)
            stream.write("\n")
    return 0 if all(value["ok"] for value in results.values() if isinstance(value, dict) and "ok" in value) else 1


if __name__ == "__main__":
    sys.exit(main())
