#!/usr/bin/env python3
"""Measures the demo on a quiet machine: waits until the machine is idle, runs build/bin/demo (two simulated rooms, world server, viewer
that records a video), keeps all figures with date, commit, machine and its score in bench/results/DATE-MACHINE-demo.json and renews
the tables of README.md and docs/measurements/README.md. `make bench-demo` builds and runs it. Ctrl-C ends it without a result and leaves
no process.
"""

import argparse
import json
import os
import signal
import sys
import tempfile

import demo_run
import machine
import readme_table


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build", help="folder of the build (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=20.0, help="length of each run, from when all programs are running (default: %(default)s)")
    parser.add_argument("--runs", type=int, default=1, help="number of runs; the figures are their medians (default: %(default)s)")
    parser.add_argument("--patience", type=float, default=120.0,
                        help="how long to wait for an idle machine before each run [s]; after that it runs anyway and marks the result (default: %(default)s)")
    parser.add_argument("--output", help="the result's file (default: bench/results/DATE-MACHINE-demo.json)")
    parser.add_argument("--no-readme", action="store_true", help="leave the tables of README.md and docs/measurements alone")
    given = parser.parse_args()
    if given.seconds < 3 or given.runs < 1:
        parser.error("at least 3 seconds and one run")
    return given


def say(text):
    print(text, file=sys.stderr, flush=True)


def measure(build, seconds, runs, patience):
    """The results of `runs` runs, each after a wait for an idle machine."""
    results = []
    for i in range(runs):
        waited, _ = machine.wait_until_idle(patience, say=say)
        say(f"run {i + 1} of {runs}: {seconds:g} s")
        with tempfile.TemporaryDirectory(prefix="bench-demo-") as output:
            result = demo_run.run(os.path.abspath(os.path.join(build, "bin", "demo")), machine.ROOT, output, seconds, say=say)
        result["waited_for_idle_s"] = round(waited, 1)
        say(f"others used {result['others_share']:.1%} of the machine meanwhile, of that steal {result['steal_share']:.1%}")
        results.append(result)
    return results


def rounded(value):
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [rounded(entry) for entry in value]
    return round(value, 4) if isinstance(value, float) else value


def main():
    given = arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    # before the first run: the score needs an idle machine too
    machine.wait_until_idle(given.patience, say=say)
    score = machine.score(given.build)
    say(f"score: {score['one_core']['score']} on one core, {score['all_cores']['score']} on all at once")
    commit, dirty = machine.commit()
    results = measure(given.build, given.seconds, given.runs, given.patience)
    now = machine.today()
    kept = {
        "command": f"make bench-demo SECONDS={given.seconds:g} RUNS={given.runs}",
        "date": now.strftime("%Y-%m-%dT%H:%MZ"),
        "commit": commit,
        "dirty": dirty,
        "machine": machine.name(),
        "cores": machine.num_cores(),
        "score": score,
        "quiet": all(result["others_share"] <= machine.QUIET_SHARE for result in results),
        "note": "figures: medians over the runs; see docs/measuring.md",
        "figures": demo_run.median_of(results),
        "runs": results,
    }
    file = given.output or os.path.join(machine.ROOT, "bench", "results",
                                        f"{now:%Y-%m-%d}-{machine.file_part(kept['machine'])}-demo.json")
    with open(file, "w", encoding="utf-8") as stream:
        json.dump(rounded(kept), stream, indent=1)
        stream.write("\n")
    print(readme_table.demo_table(rounded(kept)))
    if not given.no_readme:
        readme_table.renew_pages(file)
    say(f"kept in {os.path.relpath(file)}" + ("" if kept["quiet"] else ": NOT QUIET, others used more than "
                                              f"{machine.QUIET_SHARE:.0%} of the machine"))


if __name__ == "__main__":
    try:
        main()
    except demo_run.DemoFailed as failed:
        sys.exit(f"bench_demo: {failed}")
    except KeyboardInterrupt:
        sys.exit(130)
