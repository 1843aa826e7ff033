#!/usr/bin/env python3
"""Runs every row of the table of causes (tests/causes/*.toml) and compares exit code and message. Each command runs in an empty folder
of its own. There are two workers per core, because rows also wait. Each worker has a private network, so that nothing outside hears or
disturbs it, and no privilege: files without permission are closed to it even if root runs the test.

    tests/causes/run.py                       all rows
    tests/causes/run.py ID... FILE.toml...    these rows, with their output
"""

import argparse
import ctypes
import fcntl
import multiprocessing
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

import table

CLONE_NEWUSER, CLONE_NEWNET = 0x10000000, 0x40000000
SKIPPED = 77  # exit code, as ctest knows it (CMakeLists.txt)
LIMIT_S = 60  # ends a command that hangs; rows should take less than a second


def source_text():
    """All C++ sources and scripts, with adjacent string literals joined, to look up messages that no test can provoke."""
    parts = []
    listed = subprocess.run(["git", "-C", table.ROOT, "ls-files", "-co", "--exclude-standard", "*.cpp", "*.hpp", "*.sh", "*.py", "Makefile"],
                            capture_output=True, text=True, check=True)
    for name in listed.stdout.split():
        path = os.path.join(table.ROOT, name)
        if name.startswith("tests/") or not os.path.isfile(path):
            continue
        with open(path, encoding="utf-8") as stream:
            parts.append(re.sub(r'"\s*\n\s*"', "", stream.read()).replace('\\"', '"'))
    return "\n".join(parts)


def enter_private_network():
    """Moves this process into a network that has only its loopback. Programs that it starts have no capabilities there. Returns why not,
    or None."""
    user, group = os.geteuid(), os.getegid()
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0:
        return os.strerror(ctypes.get_errno())
    # not 0: the programs that it starts then lose the capabilities of the new namespace
    for file, text in (("setgroups", "deny"), ("uid_map", f"1000 {user} 1"), ("gid_map", f"1000 {group} 1")):
        with open(f"/proc/self/{file}", "w", encoding="ascii") as stream:
            stream.write(text)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sh14x", b"lo", 0)
        flags = struct.unpack("16sh14x", fcntl.ioctl(any_socket, 0x8913, request))[1]  # SIOCGIFFLAGS
        fcntl.ioctl(any_socket, 0x8914, struct.pack("16sh14x", b"lo", flags | 1))  # SIOCSIFFLAGS, IFF_UP
    return None


def end_group(process):
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def run_shell(script, folder, environment, options):
    """Runs a script with all it started, and returns its exit code (None: it ran too long) and its output."""
    process = subprocess.Popen(["sh", options, script], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, start_new_session=True)
    try:
        output, _ = process.communicate(timeout=LIMIT_S)
        code = process.returncode
    except subprocess.TimeoutExpired:
        code = None
    finally:
        end_group(process)
    if code is None:
        output, _ = process.communicate()
    return code, output.decode("utf-8", "replace")


def make_writable(folder):
    for path, folders, _ in os.walk(folder):
        for name in folders:
            inner = os.path.join(path, name)
            if not os.path.islink(inner):
                os.chmod(inner, 0o700)


def run_in(case, folder, bin_folder, data):
    """Runs one case in `folder`; returns its mistakes and the output."""
    home = folder + ".home"
    os.mkdir(home)
    environment = {key: value for key, value in os.environ.items()
                   if key not in ("DISPLAY", "WAYLAND_DISPLAY", "CYCLONEDDS_URI") and not key.startswith("XDG_")}
    environment.update(SOURCE=table.ROOT, BIN=bin_folder, DATA=data, HOME=home, XDG_CACHE_HOME=home, LC_ALL="C.UTF-8")
    output = ""
    if case.prepare:
        code, output = run_shell(case.prepare, folder, environment, "-euc")
        if code != 0:
            return [f"prepare ended with {'no end in time' if code is None else code}"], output
    code, output = run_shell(case.command, folder, environment, "-c")
    wrong = []
    if code is None:
        wrong.append(f"does not end by itself within {LIMIT_S} s")
    elif code != case.exit:
        wrong.append(f"exit code {code}, must be {case.exit}")
    wrong += [f"message is missing: {text}" for text in case.messages if text not in output]
    return wrong, output


def run_case(work):
    """Runs one case in an empty folder of its own."""
    case, bin_folder, data = work
    begin = time.monotonic()
    folder = tempfile.mkdtemp(prefix=f"cause_{case.id}_")
    try:
        wrong, output = run_in(case, folder, bin_folder, data)
    finally:
        make_writable(folder)
        shutil.rmtree(folder, ignore_errors=True)
        shutil.rmtree(folder + ".home", ignore_errors=True)
    return case, wrong, output, time.monotonic() - begin


def begin_worker():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends the workers
    enter_private_network()


def why_no_private_network():
    """Why no worker can have a network of its own; None if it can."""
    with multiprocessing.Pool(1) as pool:
        return pool.apply(enter_private_network)


def run_all(cases, bin_folder, data, num_workers):
    """Yields (case, mistakes, output, seconds) as the cases end."""
    with multiprocessing.Pool(num_workers, begin_worker) as pool:
        yield from pool.imap_unordered(run_case, [(case, bin_folder, data) for case in cases])


def check_by_hand(cases):
    """The cases whose message is nowhere in the sources."""
    text = source_text() if any(case.by_hand for case in cases) else ""
    for case in cases:
        missing = [message for message in case.messages if case.by_hand and message not in text]
        if missing:
            yield case, [f"message is not in the sources: {message}" for message in missing], ""


def select(cases, wanted):
    if not wanted:
        return cases
    areas = {os.path.basename(word).removesuffix(".toml") for word in wanted if word.endswith(".toml")}
    unknown = [word for word in wanted if not word.endswith(".toml") and word not in {case.id for case in cases}]
    unknown += sorted(areas - {case.area for case in cases})
    if unknown:
        sys.exit(f"no such case or file: {', '.join(unknown)}")
    return [case for case in cases if case.id in wanted or case.area in areas]


def show(case, wrong, output):
    for text in wrong:
        print(f"{case.area}.toml: {case.id}: {text}")
    for line in output.rstrip().splitlines()[-15:]:
        print(f"    {line[:400]}")
    sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", help="ids of rows or names of files; none: all")
    parser.add_argument("--bin", default=os.path.join(table.ROOT, "build", "bin"), help="folder of the programs (default: %(default)s)")
    parser.add_argument("--data", default=os.path.join(os.path.dirname(table.ROOT), "shared", "data"), help="folder of shared data (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=2 * len(os.sched_getaffinity(0)), help="rows at a time (default: %(default)s)")
    given = parser.parse_args()
    if not os.path.isfile(os.path.join(given.bin, "site_node")):
        parser.error(f"{given.bin} holds no site_node; build first, or give --bin")
    try:
        cases = select(table.read(), given.rows)
    except table.TableError as mistakes:
        sys.exit(str(mistakes))
    num_failed, slowest = 0, []
    for case, wrong, output in check_by_hand(cases):
        num_failed += 1
        show(case, wrong, output)
    if refusal := why_no_private_network():
        print(f"skipped: no private network can be made: {refusal}")
        sys.exit(1 if num_failed else SKIPPED)
    to_run = [case for case in cases if not case.by_hand and (os.path.isdir(given.data) or not case.needs_data)]
    begin = time.monotonic()
    for case, wrong, output, seconds in run_all(to_run, os.path.abspath(given.bin), os.path.abspath(given.data), given.workers):
        slowest.append((seconds, case.id))
        num_failed += bool(wrong)
        if wrong or given.rows:
            show(case, wrong or ["as expected"], output)
    num_skipped = len(cases) - len(to_run) - sum(bool(case.by_hand) for case in cases)
    print(f"{len(cases)} rows: {len(to_run)} run in {time.monotonic() - begin:.1f} s, {num_skipped} skipped without {given.data}, {num_failed} failed")
    print("slowest: " + ", ".join(f"{name} {seconds:.1f} s" for seconds, name in sorted(slowest, reverse=True)[:5]))
    sys.exit(1 if num_failed else 0)


if __name__ == "__main__":
    main()
