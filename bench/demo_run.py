"""Runs one demo and measures its programs from outside, which works for any commit. Shared by the scripts here."""

import ctypes
import datetime
import json
import os
import re
import select
import signal
import statistics
import subprocess
import time

import machine

STOP_S = 30.0  # the demo's own patience with its programs is 15 s


class DemoFailed(Exception):
    pass


def _die_with_parent():
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def read_stat(text):
    """{"parent", "cpu_s", "started_s" since boot} from a text of /proc/PID/stat. Includes the time of ended threads."""
    words = text[text.rindex(")") + 2:].split()
    hertz = os.sysconf("SC_CLK_TCK")
    return {"parent": int(words[1]), "cpu_s": (int(words[11]) + int(words[12])) / hertz, "started_s": int(words[19]) / hertz}


def _read(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:  # the process or thread has ended
        return None


def program_name(command):
    """The demo's name of the program with this command line: world, viewer, or the name of a site's file."""
    program = os.path.basename(command[0])
    if program == "site_node":
        file = command[command.index("--config") + 1]
        return os.path.splitext(os.path.basename(file))[0]
    return {"world_server": "world"}.get(program, program)


def children_of(parent):
    """{name: pid} of the programs that the demo started."""
    found = {}
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        stat = _read(f"/proc/{entry}/stat")
        if stat is None or read_stat(stat)["parent"] != parent:
            continue
        command = (_read(f"/proc/{entry}/cmdline") or "").split("\0")
        if "--config" in command:
            found[program_name(command)] = int(entry)
    return found


def waited_s(pid):
    """{thread: seconds that it was ready but had no processor}; empty if the kernel does not count it."""
    waited = {}
    try:
        threads = os.listdir(f"/proc/{pid}/task")
    except OSError:
        return waited
    for thread in threads:
        words = (_read(f"/proc/{pid}/task/{thread}/schedstat") or "").split()
        if len(words) == 3:
            waited[thread] = int(words[1]) / 1e9
    return waited


def memory_mb(pid):
    status = _read(f"/proc/{pid}/status") or ""
    def value(key):
        found = re.search(rf"^{key}:\s*(\d+) kB$", status, re.MULTILINE)
        return int(found.group(1)) * 1024 / 1e6 if found else 0.0
    return {"resident": value("VmRSS"), "own": value("RssAnon"), "of_files": value("RssFile"), "peak": value("VmHWM")}


class Sample:
    """Processor time, waiting time and memory of the demo's programs at one time."""

    def __init__(self, programs, demo_pid):
        self.time = time.monotonic()
        self.cpu = machine.CpuTimes.now()
        self.cpu_s, self.waited, self.memory = {}, {}, {}
        for name, pid in programs.items():
            stat = _read(f"/proc/{pid}/stat")
            if stat is None:
                raise DemoFailed(f"{name} has ended")
            self.cpu_s[name] = read_stat(stat)["cpu_s"]
            self.waited[name] = waited_s(pid)
            self.memory[name] = memory_mb(pid)
        own = os.times()
        self.own_s = sum(self.cpu_s.values()) + own.user + own.system + read_stat(_read(f"/proc/{demo_pid}/stat") or "0 () S 0" + " 0" * 30)["cpu_s"]


def site_rates(lines):
    """{site: [metaframes/s of each second]} from the demo's tables."""
    rates = {}
    for line in lines:
        found = re.match(r"(\S+)\s+([\d.]+) metaframes/s", line)
        if found:
            rates.setdefault(found.group(1), []).append(float(found.group(2)))
    return rates


def used_between(begin, end, num_metaframes_per_s):
    """Per program: processor and waiting time per metaframe of all sites (of its own for a site), and share of one core."""
    length = end.time - begin.time
    used = {}
    total_rate = sum(num_metaframes_per_s.values())
    for name, cpu_s in end.cpu_s.items():
        rate = num_metaframes_per_s.get(name, total_rate)
        busy = (cpu_s - begin.cpu_s[name]) / length
        waited = sum(s - begin.waited[name].get(thread, 0.0) for thread, s in end.waited[name].items()) / length
        used[name] = {
            "processor_ms_per_metaframe": 1000.0 * busy / rate if rate > 0 else None,
            "waiting_ms_per_metaframe": 1000.0 * waited / rate if rate > 0 and end.waited[name] else None,
            "core_share": busy,
            "memory_mb": end.memory[name],
        }
    return used


def log_time(line):
    """Seconds since 1970 of a log line, None if it has no time."""
    try:
        return datetime.datetime.fromisoformat(line.split(" ", 1)[0]).timestamp()
    except ValueError:
        return None


def first_event(log, event):
    """Time of the first such event in a log, None if there is none."""
    for line in log.splitlines():
        if event in line:
            return log_time(line)
    return None


def start_seconds(output, started):
    """Time from each program's start to the event that its user waits for, from the logs: {name: seconds}. started: {name: seconds since 1970}.

    A site: until the viewer shows its person. The world server: until it runs. The viewer: until it has a surface to draw on.
    """
    logs = {name: _read(os.path.join(output, name + ".log")) or "" for name in started}
    result = {}
    for name, begin in started.items():
        if name == "world":
            end = first_event(logs[name], " running world=")
        elif name == "viewer":
            end = first_event(logs[name], " surface_open ")
        else:
            end = first_event(logs.get("viewer", ""), f" person_shown site={name} ")
        if end is not None:
            result[name] = round(end - begin, 3)
    return result


def started_at(pid):
    """Seconds since 1970."""
    uptime = float(_read("/proc/uptime").split()[0])
    return time.time() - uptime + read_stat(_read(f"/proc/{pid}/stat"))["started_s"]


def stop(demo):
    """Ends a demo like Ctrl-C, and kills it after a while. Its programs end with it even then."""
    for number in (signal.SIGINT, signal.SIGKILL):
        if demo.poll() is not None:
            return
        demo.send_signal(number)
        try:
            demo.wait(STOP_S)
        except subprocess.TimeoutExpired:
            pass


def _table_each_second(program, tree):
    """The option for a table once a second; older demos always print one."""
    told = subprocess.run([program, "--help"], cwd=tree, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    return ["--table-seconds", "1"] if "--table-seconds" in told.stdout else []


def run(program, tree, output, seconds, options=(), say=lambda text: None):
    """Runs `program` (a demo) in `tree` and returns its figures:

    {"report": its report.json, "programs": {name: see used_between}, "start_s": see start_seconds, "rates": {site: mean metaframes/s},
    "seconds": length of what was measured, "others_share", "steal_share": of all cores, see machine.shares}
    """
    os.makedirs(output, exist_ok=True)
    command = [program, "--seconds", f"{seconds:g}", "--output", output, *_table_each_second(program, tree), *options]
    demo = subprocess.Popen(command, cwd=tree, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            start_new_session=True, preexec_fn=_die_with_parent)
    try:
        return _watch(demo, output, say)
    finally:
        stop(demo)
        demo.stdout.close()


def _watch(demo, output, say):
    programs, started, samples, lines, tail = {}, {}, [], [], []
    rest = b""
    while True:
        if not select.select([demo.stdout], [], [], 60.0)[0] and demo.poll() is None:
            raise DemoFailed("the demo has printed nothing for a minute")
        data = os.read(demo.stdout.fileno(), 65536)
        if not data:
            break
        rest += data
        *whole, rest = rest.split(b"\n")
        for line in (raw.decode("utf-8", "replace") for raw in whole):
            tail = (tail + [line])[-20:]
            if not samples and line.startswith("program "):  # the table's heading, once a second
                for name, pid in children_of(demo.pid).items():
                    if name not in programs:
                        programs[name], started[name] = pid, started_at(pid)
            if re.match(r"time\s+\d+", line):
                samples.append(Sample(programs, demo.pid))
                say(line.strip())
            elif samples:
                lines.append(line)
    code = demo.wait(STOP_S)
    report = _read(os.path.join(output, "report.json"))
    if code != 0 or report is None or len(samples) < 2:
        raise DemoFailed(f"the demo ended with exit code {code}:\n" + "\n".join(tail))
    rates = {site: statistics.fmean(values) for site, values in site_rates(lines).items()}
    begin, end = samples[0], samples[-1]
    end.memory = samples[-2].memory  # at the last one the programs may be ending
    others = machine.shares(begin.cpu, end.cpu, end.own_s - begin.own_s)
    return {
        "report": json.loads(report),
        "programs": used_between(begin, end, rates),
        "start_s": start_seconds(output, started),
        "rates": rates,
        "seconds": end.time - begin.time,
        "others_share": others["others"],
        "steal_share": others["steal"],
    }


def median_of(values):
    """The median of results of equal structure: of numbers, also inside dictionaries. Of other values, the first."""
    first = next((value for value in values if value is not None), None)
    if isinstance(first, dict):
        found = [value for value in values if isinstance(value, dict)]
        return {key: median_of([value[key] for value in found if key in value]) for key in first}
    numbers = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
    return statistics.median(numbers) if numbers else first
