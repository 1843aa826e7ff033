"""Records a world, plays it again and compares: see record_world.sh."""

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine  # noqa: E402
import page_table  # noqa: E402

PAGE = os.path.join(machine.ROOT, "docs", "measurements", "recording.md")
WORLD = "record-world"
SETTLE_S = 10.0  # the simulated rooms are rendered, everybody is on


def start(binary, *arguments, **more):
    return subprocess.Popen([binary, *arguments], stderr=subprocess.DEVNULL, **more)


def end(processes):
    for process in processes:
        process.send_signal(signal.SIGINT)
    for process in processes:
        process.wait(timeout=30)


def record(folder, binaries, seconds):
    """Runs the world and a recorder; returns the file and what it cost."""
    world = [start(f"{binaries}/site_node", "--config", f"deploy/sites/{name}.toml", "--world", WORLD) for name in ("alice", "bob")]
    world.append(start(f"{binaries}/world_server", "--config", "deploy/worlds/demo.toml", "--world", WORLD))
    world.append(start(f"{binaries}/viewer", "--headless", "--world", WORLD))
    time.sleep(SETTLE_S)
    file = os.path.join(folder, "world.mcap")
    before = machine.CpuTimes.now()
    recorder = subprocess.Popen([f"{binaries}/record", "--world", WORLD, "--seconds", str(seconds), "-o", file],
                                stderr=subprocess.PIPE, text=True)
    log = recorder.stderr.read()
    _, status, usage = os.wait4(recorder.pid, 0)
    after = machine.CpuTimes.now()
    end(world)
    if status != 0:
        sys.exit(f"record failed: {log}")
    words = dict(word.split("=", 1) for word in log.splitlines()[-1].split() if "=" in word)
    cpu_s = usage.ru_utime + usage.ru_stime
    return file, {"cpu_share": cpu_s / seconds, "memory_mb": usage.ru_maxrss / 1024.0, "mb": os.path.getsize(file) / 1e6,
                  "mb_per_min": os.path.getsize(file) / 1e6 / (seconds / 60.0), "samples": int(words["samples"]),
                  "dropped": int(words["dropped"]), "host_idle": 1.0 - (1.0 - (after.idle - before.idle) / (os.cpu_count() * seconds))}


def replay(file, binaries):
    """Plays the file to a program that compares; returns what it found."""
    player = subprocess.Popen([f"{binaries}/play", file, "--paused", "--world", "replay"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, text=True)
    checker = subprocess.Popen([f"{binaries}/replay_check", file], stdout=subprocess.PIPE, text=True)
    for answer, order in (("matched\n", '{"do": "seek", "time_s": 0}\n'), ("ready\n", '{"do": "play"}\n')):
        assert checker.stdout.readline() == answer
        player.stdin.write(order)
        player.stdin.flush()
    found = json.loads(checker.stdout.readline())
    player.stdin.close()
    end([player])
    checker.wait()
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--out", required=True)
    options = parser.parse_args()
    binaries = os.path.join(options.build, "bin")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory() as folder:
        file, cost = record(folder, binaries, options.seconds)
        played = replay(file, binaries)
        seeks = json.loads(subprocess.check_output([f"{binaries}/replay_check", file, "--seeks", "100"], text=True))
    result = {"origin": machine.origin(options.build), "seconds": options.seconds, "record": cost, "play": played, "seek": seeks}
    with open(options.out, "w", encoding="utf-8") as out:
        json.dump(result, out, indent=1)
    different = [name for name, topic in played["topics"].items() if not topic["hashes_equal"]]
    num = sum(topic["recorded"] for topic in played["topics"].values())
    rows = ["| | |", "|---|---|",
            f"| recorded | {options.seconds:.0f} s, two sites of 8 cameras at 30 Hz, {cost['samples']} samples, {cost['dropped']} dropped |",
            f"| recorder | {100.0 * cost['cpu_share']:.1f} % of a core, {cost['memory_mb']:.0f} MB of memory |",
            f"| file | {cost['mb']:.0f} MB, {cost['mb_per_min']:.0f} MB per minute |",
            f"| played again | {num} samples of {len(played['topics'])} topics, "
            + ("all with the same bytes in the same order" if not different else f"different: {', '.join(different)}") + " |",
            f"| times | off by {played['time_error_ms']['median']:.2f} ms (median), {played['time_error_ms']['p99']:.2f} ms (p99) |",
            f"| 100 random jumps | {seeks['median_ms']:.0f} ms (median), {seeks['p90_ms']:.0f} ms (p90), {seeks['max_ms']:.0f} ms (longest) |"]
    if os.path.exists(PAGE):
        page_table.put_table(PAGE, "record-world", rows, machine.origin_line(result["origin"]))
    print("\n".join(rows))


if __name__ == "__main__":
    main()
