"""Counts the instructions per metaframe of site, world server and viewer (bench/metaframe_work.cpp, fixed input, one thread), and compares
them with the figures kept in bench/instructions.json. Prints the ratios, and fails if one is above 1.15.

The counter is valgrind's callgrind. It needs no rights and no hardware counters, and counts the same on every machine, because it emulates the
same processor (with AVX2 if the machine has it). Takes one to three minutes on 2 cores, under any load. The profiles stay in
BUILD/metaframes: callgrind_annotate BUILD/metaframes/viewer.callgrind

exit codes: 0 at most 15 % above the kept figures; 1 more, or no figures are kept for this kind of processor; 2 wrong command line; 3 something is missing;
4 valgrind does not know an instruction that this processor runs, so nothing can be counted here
"""

import argparse
import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys

import machine

KEPT = os.path.join(machine.ROOT, "bench", "instructions.json")
STAGES = {"site": "a site: 8 pictures to coded mesh and textures",
          "world": "world server: meshes of two sites to people, 4 steps",
          "viewer": "viewer: frames of two sites to people, one picture of 960x540"}
LIMIT = 1.15


def fail(text, code):
    print(f"instructions: {text}", file=sys.stderr)
    sys.exit(code)


def processor():
    """The processor that valgrind emulates here. It has AVX2 if the machine has it."""
    with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
        flags = re.search(r"^flags\s*:\s*(.*)$", file.read(), re.MULTILINE)
    return "x86-64 with AVX2" if flags and "avx2" in flags.group(1).split() else "x86-64 without AVX2"


def collected(text):
    """Instructions that callgrind counted, from its output; None if it printed none."""
    found = re.search(r"Collected : (\d+)$", text, re.MULTILINE)
    return int(found.group(1)) if found and int(found.group(1)) > 0 else None


def unknown_instruction(text):
    """The line in which valgrind says that it does not know an instruction, from its output; None if there is none."""
    found = re.search(r"^.*unhandled instruction bytes: .*$", text, re.MULTILINE)
    return found.group(0) if found else None


def run(command, **more):
    return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                          check=False, **more)


def count(stage, program, folder, num):
    """Instructions per metaframe of a stage, mean over `num`."""
    command = ["valgrind", "--tool=callgrind", "--instr-atstart=no", f"--callgrind-out-file={folder}/{stage}.callgrind", program, stage, folder, str(num)]
    # independent of the user's settings
    environment = {**os.environ, "LP_NUM_THREADS": "0", "MESA_SHADER_CACHE_DISABLE": "true", "VALGRIND_OPTS": ""}
    done = run(command, env=environment)
    instructions = collected(done.stdout)
    unknown = unknown_instruction(done.stdout)
    if instructions is None and unknown:
        fail(f"nothing was counted: valgrind does not know an instruction of this processor, or of a library that uses it here: {unknown}", 4)
    if done.returncode != 0 or instructions is None:
        fail(f"{' '.join(command)} ended with exit code {done.returncode}:\n{done.stdout[-2000:]}", 3)
    return instructions / num


def measure(build, num):
    """{stage: instructions per metaframe}."""
    program = os.path.abspath(os.path.join(build, "bin", "metaframe_work"))
    folder = os.path.abspath(os.path.join(build, "metaframes"))
    if shutil.which("valgrind") is None:
        fail("valgrind is not there; deploy/install_packages.sh installs it", 3)
    if not os.access(program, os.X_OK):
        fail(f"{program} is not there; build the target metaframe_work", 3)
    prepared = run([program, "prepare", folder])
    if prepared.returncode != 0:
        fail(f"{program} prepare {folder} ended with exit code {prepared.returncode}:\n{prepared.stdout[-2000:]}", 3)
    with concurrent.futures.ThreadPoolExecutor(machine.num_cores()) as pool:
        # the longest first
        jobs = {stage: pool.submit(count, stage, program, folder, num) for stage in reversed(STAGES)}
        return {stage: jobs[stage].result() for stage in STAGES}


def compare(kept, now):
    """(lines to print, whether all are within the limit); kept and now: {stage: instructions per metaframe}."""
    lines = [f"{'instructions per metaframe [millions]':<66} {'kept':>8} {'now':>8} {'ratio':>7}"]
    within = True
    for stage, text in STAGES.items():
        ratio = now[stage] / kept[stage]
        lines.append(f"{text:<66} {kept[stage] / 1e6:8.1f} {now[stage] / 1e6:8.1f} {ratio:7.3f}{'  MORE THAN 1.15' if ratio > LIMIT else ''}")
        within = within and ratio <= LIMIT
    return lines, within


def load():
    try:
        with open(KEPT, encoding="utf-8") as file:
            return json.load(file)
    except FileNotFoundError:
        return {"note": "Instructions per metaframe; bench/instructions.sh --renew writes this file, docs/measuring.md explains it.", "kept": {}}


def main():
    parser = argparse.ArgumentParser(prog="bench/instructions.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default="build", help="folder of the build (default: %(default)s)")
    parser.add_argument("--renew", action="store_true", help="keep the new figures")
    parser.add_argument("--metaframes", type=int, default=8, help="number of counted metaframes, 1 to 16 (default: %(default)s)")
    given = parser.parse_args()
    if not 1 <= given.metaframes <= 16:
        parser.error("--metaframes: 1 to 16")
    content = load()
    kind = processor()
    kept = content["kept"].get(kind)
    now = measure(given.build, given.metaframes)
    lines, within = compare(kept["per_metaframe"] if kept else now, now)
    print("\n".join(lines))
    if given.renew:
        commit, dirty = machine.commit()
        version = run(["valgrind", "--version"]).stdout.strip()
        content["kept"][kind] = {"date": machine.today().strftime("%Y-%m-%d"), "commit": commit + (" with changes" if dirty else ""), "counter": version,
                                 "per_metaframe": {stage: round(figure) for stage, figure in now.items()}}
        with open(KEPT, "w", encoding="utf-8") as file:
            json.dump(content, file, indent=1)
            file.write("\n")
        print(f"kept in {os.path.relpath(KEPT)}")
    elif not kept:
        fail(f"nothing is kept for {kind}; bench/instructions.sh --renew on such a machine keeps these figures", 1)
    elif not within:
        fail(f"more than {LIMIT - 1:.0%} above what is kept of {kept['date']}. Find out why: callgrind_annotate {given.build}/metaframes/STAGE.callgrind; "
             "where it is meant to be so, bench/instructions.sh --renew", 1)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
