"""Describes the machine and the tree of a measurement: name, cores, score, idle share, commit. Shared by the scripts here."""

import datetime
import json
import os
import re
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
QUIET_SHARE = 0.05  # of all cores: limit of use by others for an idle machine, steal included


class CpuTimes:
    """The counters of /proc/stat's first line [s, all cores together]."""

    def __init__(self, line):
        names = ("user", "nice", "system", "idle", "iowait", "irq", "softirq", "steal")
        words = line.split()
        if words[0] != "cpu" or len(words) < 1 + len(names):
            raise ValueError(f"/proc/stat: unexpected line: {line}")
        hertz = os.sysconf("SC_CLK_TCK")
        for name, word in zip(names, words[1:]):
            setattr(self, name, int(word) / hertz)

    @staticmethod
    def now():
        with open("/proc/stat", encoding="ascii") as file:
            return CpuTimes(file.readline())


def shares(begin, end, own_s=0.0):
    """Use by other programs between two CpuTimes, as shares of all cores: {"others", "steal"}; own_s: processor time of the measured programs.

    Time in interrupts counts for nobody: most of it is the measured programs' own traffic.
    """
    names = ("user", "nice", "system", "idle", "iowait", "irq", "softirq", "steal")
    total = sum(getattr(end, name) - getattr(begin, name) for name in names)
    if total <= 0.0:
        return {"others": 0.0, "steal": 0.0}
    busy = sum(getattr(end, name) - getattr(begin, name) for name in ("user", "nice", "system"))
    steal = end.steal - begin.steal
    return {"others": max(0.0, busy - own_s) / total + steal / total, "steal": steal / total}


def wait_until_idle(patience_s, window_s=3.0, say=lambda text: print(text, file=sys.stderr, flush=True)):
    """Waits until others use at most QUIET_SHARE of all cores for window_s, at most patience_s. Returns (seconds waited, last shares)."""
    begin = time.monotonic()
    while True:
        before = CpuTimes.now()
        time.sleep(window_s)
        used = shares(before, CpuTimes.now())
        waited = time.monotonic() - begin
        if used["others"] <= QUIET_SHARE:
            say(f"idle: others use {used['others']:.1%} of the machine")
            return waited, used
        with open("/proc/loadavg", encoding="ascii") as file:
            load = file.read().split()[0]
        state = f"others use {used['others']:.0%} of the machine (steal {used['steal']:.0%}, load {load})"
        if waited >= patience_s:
            say(f"not idle after {waited:.0f} s: {state}; goes on, and the result is marked as not quiet")
            return waited, used
        say(f"not idle: {state}; waits, {waited:.0f} of at most {patience_s:.0f} s")


def name():
    """The processor's model name."""
    with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
        found = re.search(r"^model name\s*:\s*(.*)$", file.read(), re.MULTILINE)
    return found.group(1).strip() if found else "unknown processor"


def file_part(text):
    """A text as a part of a file name, in the form of the other scripts here."""
    return re.sub(r"[^A-Za-z0-9]", "-", text)


def num_cores():
    return len(os.sched_getaffinity(0))


def score(build):
    """The output of machine_score, as a dictionary."""
    program = os.path.join(build, "bin", "machine_score")
    return json.loads(subprocess.run([program, "--json"], check=True, capture_output=True, text=True).stdout)


def today():
    return datetime.datetime.now(datetime.timezone.utc)


def git(*arguments, tree=ROOT):
    done = subprocess.run(["git", "-C", tree, *arguments], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else None


def commit(tree=ROOT):
    """(short commit or "unknown", whether files other than results of measurements are changed)."""
    short = git("rev-parse", "--short=7", "HEAD", tree=tree)
    if short is None:
        return "unknown", True
    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!README.md", ":!bench/results", ":!docs", tree=tree)
    return short, changed != ""


def origin(build):
    """Where and when a result was measured: {"date", "commit" (with + if files are changed), "machine", "cores", "score"}."""
    short, is_changed = commit()
    return {"date": today().strftime("%Y-%m-%dT%H:%MZ"), "commit": short + ("+" if is_changed else ""), "machine": name(), "cores": num_cores(),
            "score": score(build)}


def origin_line(origin_of_result):
    """The same for the line below a table."""
    one = origin_of_result
    return f"{one['date']}, commit {one['commit']}, {one['machine']}, score {one['score']['one_core']['score']:.0f}"
