"""Compares the demos of two commits. Builds both, runs their demos in turn (A B A B ...) on the idle machine, prints a table with the
ratios of the medians (B / A), and keeps all figures in bench/results/DATE-MACHINE-whole-A-B.json.

Processor time, waiting time and memory are read from outside (/proc), which works for commits that do not report them. The commits
are git worktrees in .cache/whole, and stay there built; you can remove the folder. The rooms are rendered before the first round.
Ctrl-C ends it, leaves no process, and keeps the rounds so far.

  bench/whole.sh e3e7f11 HEAD            # three rounds of 20 s
  bench/whole.sh e3e7f11 HEAD 5 30
"""

import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile

import demo_run
import machine

HOME = os.path.join(machine.ROOT, ".cache", "whole")


def say(text):
    print(text, file=sys.stderr, flush=True)


def arguments():
    parser = argparse.ArgumentParser(prog="bench/whole.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("a", metavar="A", help="a commit")
    parser.add_argument("b", metavar="B", help="the commit to compare with it")
    parser.add_argument("rounds", nargs="?", type=int, default=3, help="runs of each (default: %(default)s)")
    parser.add_argument("seconds", nargs="?", type=float, default=20.0, help="length of each run, from when all programs are running (default: %(default)s)")
    parser.add_argument("--build-a", metavar="DIR", help="a tree of commit A with its programs in DIR/build/bin, instead of a worktree")
    parser.add_argument("--build-b", metavar="DIR", help="likewise of commit B")
    parser.add_argument("--patience", type=float, default=120.0,
                        help="how long to wait for an idle machine before each run [s]; after that it runs anyway and marks the run (default: %(default)s)")
    parser.add_argument("--keep", metavar="FILE", help="file of the result; adds the rounds to an existing file of the same commits")
    given = parser.parse_args()
    if given.rounds < 1 or given.seconds < 3:
        parser.error("at least one round of 3 seconds")
    return given


class Side:
    """One of the two commits, with its tree, and a working folder with its rooms."""

    def __init__(self, letter, revision, tree):
        self.letter = letter
        self.commit = machine.git("rev-parse", "--short=7", f"{revision}^{{commit}}")
        if self.commit is None:
            sys.exit(f"whole: {revision}: no commit of this repository")
        self.tree = os.path.abspath(tree) if tree else os.path.join(HOME, self.commit)
        self.given = tree is not None
        self.folder = os.path.join(HOME, "run", f"{self.commit}{'-given' if self.given else ''}")
        os.makedirs(self.folder, exist_ok=True)

    def program(self, name):
        return os.path.join(self.tree, "build", "bin", name)

    def build(self):
        if self.given:
            if not os.path.exists(self.program("demo")):
                sys.exit(f"whole: {self.program('demo')}: no such program")
            return
        if not os.path.exists(os.path.join(self.tree, ".git")):
            machine.git("worktree", "prune")
            if machine.git("worktree", "add", "--detach", self.tree, self.commit) is None:
                sys.exit(f"whole: cannot create the worktree {self.tree}")
        log = os.path.join(self.folder, "build.log")
        say(f"{self.letter}: builds {self.commit} in {os.path.relpath(self.tree)} (see {os.path.relpath(log)})")
        with open(log, "wb") as output:
            build = subprocess.Popen(["deploy/build.sh", "build"], cwd=self.tree, env={**os.environ, "TARGETS": "programs"},
                                     stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
            try:
                code = build.wait()
            finally:
                if build.poll() is None:
                    os.killpg(build.pid, signal.SIGTERM)
                    build.wait()
        if code != 0:
            sys.exit(f"whole: {self.commit} cannot be built; see {log}")

    def run(self, seconds, tell=lambda text: None):
        # a separate working folder: each commit renders its own rooms
        options = ["--deploy", os.path.join(self.tree, "deploy"), "--world", os.path.join(self.tree, "deploy", "worlds", "demo.toml"),
                   "--viewer", os.path.join(self.tree, "deploy", "viewer.toml")]
        with tempfile.TemporaryDirectory(prefix="whole-") as output:
            return demo_run.run(self.program("demo"), self.folder, output, seconds, options, tell)

    def make_rooms(self):
        if not os.path.isdir(os.path.join(self.folder, ".cache", "simulation")):
            say(f"{self.letter}: makes its rooms")
            self.run(3)


def figures(run):
    """{name: (value, unit)} of one run, in the table's order; value None if it was not measured."""
    rows = {}
    report = run["report"]
    for site in sorted(report["sites"]):
        of = report["sites"][site]
        rows[f"{site}: metaframes/s"] = (run["rates"].get(site), "")
        rows[f"{site}: dropped"] = (of["dropped"], "")
        rows[f"{site}: capture to publish, median"] = (of["capture_to_publish_ms"]["median"], "ms")
        rows[f"{site}: capture to publish, p99"] = (of["capture_to_publish_ms"]["p99"], "ms")
    for text, of in (("world: capture to collision", report["world"]["capture_to_collision_ms"]),
                     ("viewer: capture to display", report["viewer"]["capture_to_display_ms"])):
        rows[f"{text}, median"] = (of["median"], "ms")
        rows[f"{text}, p99"] = (of["p99"], "ms")
    rows["world: steps/s"] = (report["world"]["steps_per_s"], "")
    rows["viewer: pictures/s"] = (report["viewer"]["frames_per_s"], "")
    # of viewers that reduce their quality on a slow machine: a ratio of times alone would hide it
    rows["viewer: resolution of the scene"] = (None if "scale" not in report["viewer"] else 100.0 * report["viewer"]["scale"], "%")
    rows["viewer: shadows (1: on)"] = (report["viewer"].get("shadows"), "")
    rows["viewer: pairs shown"] = (report["viewer"]["pairs_shown"], "")
    rows["viewer: pairs skipped"] = (report["viewer"]["pairs_skipped"], "")
    for name, of in run["programs"].items():
        rows[f"{name}: processor time per metaframe"] = (of["processor_ms_per_metaframe"], "ms")
        rows[f"{name}: waiting per metaframe"] = (of["waiting_ms_per_metaframe"], "ms")
        rows[f"{name}: share of one core"] = (100.0 * of["core_share"], "%")
    viewer = run["programs"].get("viewer")
    if viewer and report["viewer"]["frames_per_s"] > 0:
        rows["viewer: processor time per picture"] = (1000.0 * viewer["core_share"] / report["viewer"]["frames_per_s"], "ms")
    for name, of in run["programs"].items():
        rows[f"{name}: memory, resident"] = (of["memory_mb"]["resident"], "MB")
        rows[f"{name}: memory, of its own"] = (of["memory_mb"]["own"], "MB")
    for name, of in (*report["sites"].items(), ("world", report["world"]), ("viewer", report["viewer"])):
        rows[f"{name}: start to first output"] = (of.get("first_output_s"), "s")
    for name, seconds in run["start_s"].items():
        rows[f"{name}: start"] = (seconds, "s")
    rows["others used of the machine"] = (100.0 * run["others_share"], "%")
    return rows


def medians(runs):
    values = {}
    for run in runs:
        for name, (value, unit) in figures(run).items():
            if value is not None:
                values.setdefault(name, ([], unit))[0].append(value)
    return {name: (statistics.median(of), unit) for name, (of, unit) in values.items()}


def table(kept):
    a, b = medians(kept["runs"]["a"]), medians(kept["runs"]["b"])
    lines = [f"| medians of {len(kept['runs']['a'])} and {len(kept['runs']['b'])} runs of {kept['seconds']:g} s | A {kept['a']} | B {kept['b']} | B / A |",
             "|---|---|---|---|"]
    for name in [*a, *(name for name in b if name not in a)]:
        texts = [f"{side[name][0]:.1f} {side[name][1]}".strip() if name in side else "not measured" for side in (a, b)]
        ratio = f"{b[name][0] / a[name][0]:.2f}" if name in a and name in b and a[name][0] > 0 else ""
        lines.append(f"| {name} | {texts[0]} | {texts[1]} | {ratio} |")
    score = kept["score"]
    speed = (f"machine score {score['one_core']['score']:.0f} on one core, {score['all_cores']['score']:.0f} on all" if score
             else "machine score not measured")
    loud = sum(run["others_share"] > machine.QUIET_SHARE for side in ("a", "b") for run in kept["runs"][side])
    lines += ["", f"{kept['date']}, {kept['machine']}, {kept['cores']} cores, {speed}; " +
              (f"**{loud} runs not quiet**" if loud else "all runs quiet") + "."]
    return "\n".join(lines)


def score(sides):
    for build in (*(os.path.join(side.tree, "build") for side in reversed(sides)), os.path.join(machine.ROOT, "build")):
        if os.path.exists(os.path.join(build, "bin", "machine_score")):
            return machine.score(build)
    say("no machine_score in build/bin of either commit nor of this tree: the result has no score")
    return None


def begin_result(given, a, b):
    file = given.keep or os.path.join(machine.ROOT, "bench", "results",
                                      f"{machine.today():%Y-%m-%d}-{machine.file_part(machine.name())}-whole-{a.commit}-{b.commit}.json")
    if given.keep and os.path.exists(file):
        with open(file, encoding="utf-8") as stream:
            kept = json.load(stream)
        if (kept["a"], kept["b"], kept["seconds"]) != (a.commit, b.commit, given.seconds):
            sys.exit(f"whole: {file} holds {kept['a']} and {kept['b']} at {kept['seconds']:g} s: rounds of others cannot be added")
        return file, kept
    return file, {"command": "bench/whole.sh " + " ".join(sys.argv[1:]), "date": machine.today().strftime("%Y-%m-%dT%H:%MZ"),
                  "a": a.commit, "b": b.commit, "machine": machine.name(), "cores": machine.num_cores(), "score": None,
                  "seconds": given.seconds, "runs": {"a": [], "b": []}}


def keep(file, kept):
    with open(file + ".new", "w", encoding="utf-8") as stream:
        json.dump(kept, stream, indent=1)
        stream.write("\n")
    os.replace(file + ".new", file)


def main():
    given = arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    sides = [Side("A", given.a, given.build_a), Side("B", given.b, given.build_b)]
    for side in sides:
        side.build()
    for side in sides:
        side.make_rooms()
    file, kept = begin_result(given, *sides)
    if kept["score"] is None:
        machine.wait_until_idle(given.patience, say=say)
        kept["score"] = score(sides)
    try:
        for i in range(given.rounds):
            for side in sides:
                machine.wait_until_idle(given.patience, say=say)
                say(f"round {i + 1} of {given.rounds}, {side.letter} {side.commit}: {given.seconds:g} s")
                run = side.run(given.seconds)
                rates = ", ".join(f"{name} {rate:.1f}/s" for name, rate in run["rates"].items())
                say(f"  {rates}, capture to display {run['report']['viewer']['capture_to_display_ms']['median']:.0f} ms, "
                    f"others used {run['others_share']:.1%}")
                kept["runs"][side.letter.lower()].append(run)
                keep(file, kept)
    finally:
        if kept["runs"]["a"] and kept["runs"]["b"]:
            print(table(kept))
            say(f"kept in {os.path.relpath(file)}")


if __name__ == "__main__":
    try:
        main()
    except demo_run.DemoFailed as failed:
        sys.exit(f"whole: {failed}")
    except KeyboardInterrupt:
        sys.exit(130)
