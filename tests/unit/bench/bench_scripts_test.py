"""Tests the computations of the scripts in bench/. They start no demo. Run by ctest: python3 tests/unit/bench/bench_scripts_test.py"""

import contextlib
import copy
import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "bench"))
import demo_run
import instructions
import machine
import page_table
import readme_table
import whole

HERTZ = os.sysconf("SC_CLK_TCK")


def cpu(user=0, nice=0, system=0, idle=0, iowait=0, irq=0, softirq=0, steal=0):
    values = (user, nice, system, idle, iowait, irq, softirq, steal)
    return machine.CpuTimes("cpu  " + " ".join(str(int(value * HERTZ)) for value in values) + " 0 0")


def result(date="2026-11-23T15:00Z", quiet=True):
    program = {"processor_ms_per_metaframe": 12.34, "waiting_ms_per_metaframe": 1.0, "core_share": 0.37,
               "memory_mb": {"resident": 500.0, "own": 100.0, "of_files": 400.0, "peak": 510.0}}
    site = {"capture_to_publish_ms": {"median": 20.0, "p99": 71.0}, "bytes_per_s": 1e6, "dropped": 3, "metaframes_published": 567}
    figures = {"report": {"sites": {"alice": site, "bob": site},
                          "world": {"capture_to_collision_ms": {"median": 50.0, "p99": 90.0}, "steps_per_s": 120.0},
                          "viewer": {"capture_to_display_ms": {"median": 66.0, "p99": 139.0}, "frames_per_s": 29.9}},
               "programs": {name: program for name in ("alice", "bob", "world", "viewer")},
               "start_s": {"alice": 3.2, "bob": 3.3, "world": 0.1}, "rates": {"alice": 30.0, "bob": 29.5},
               "seconds": 20.0, "others_share": 0.011, "steal_share": 0.01, "waited_for_idle_s": 3.0}
    return {"date": date, "commit": "0123456", "dirty": False, "machine": "Some CPU", "cores": 2, "quiet": quiet,
            "score": {"one_core": {"score": 100.0}, "all_cores": {"score": 90.0}}, "figures": figures, "runs": [figures]}


class Shares(unittest.TestCase):
    def test_counts_steal_and_leaves_out_own_time(self):
        used = machine.shares(cpu(), cpu(user=6, system=1, idle=9, softirq=2, steal=2), own_s=5.0)
        self.assertAlmostEqual(used["others"], (2.0 + 2.0) / 20.0)
        self.assertAlmostEqual(used["steal"], 0.1)

    def test_shares_are_never_negative(self):
        self.assertEqual(machine.shares(cpu(), cpu(user=1, idle=1), own_s=1.5)["others"], 0.0)

    def test_refuses_a_line_of_one_core(self):
        with self.assertRaises(ValueError):
            machine.CpuTimes("cpu0 1 2 3 4 5 6 7 8")


class WaitUntilIdle(unittest.TestCase):
    def wait(self, busy_shares, patience_s):
        times, total, busy = [], 0.0, 0.0
        for share in busy_shares:
            times.append(cpu(user=busy, idle=total - busy))
            total, busy = total + 100.0, busy + 100.0 * share
            times.append(cpu(user=busy, idle=total - busy))
        said = []
        clock = iter(range(0, 1000, 3))
        with mock.patch.object(machine.CpuTimes, "now", side_effect=times), mock.patch.object(machine.time, "sleep"), \
                mock.patch.object(machine.time, "monotonic", side_effect=clock):
            waited, used = machine.wait_until_idle(patience_s, say=said.append)
        return waited, used, said

    def test_waits_until_others_have_ended(self):
        waited, used, said = self.wait([0.9, 0.5, 0.01], patience_s=60)
        self.assertEqual(waited, 9)
        self.assertAlmostEqual(used["others"], 0.01)
        self.assertEqual([line.split(":")[0] for line in said], ["not idle", "not idle", "idle"])

    def test_gives_up_after_its_patience_and_reports_it(self):
        waited, used, said = self.wait([0.9] * 5, patience_s=6)
        self.assertEqual(waited, 6)
        self.assertAlmostEqual(used["others"], 0.9)
        self.assertIn("not quiet", said[-1])


class Processes(unittest.TestCase):
    def test_reads_a_stat_line_with_blanks_and_brackets_in_the_name(self):
        text = f"12 (a) b (c) S 7 12 12 0 -1 0 0 0 0 0 {3 * HERTZ} {2 * HERTZ} 99 99 20 0 1 0 {50 * HERTZ} 0"
        self.assertEqual(demo_run.read_stat(text), {"parent": 7, "cpu_s": 5.0, "started_s": 50.0})

    def test_names_programs_as_the_demo_does(self):
        self.assertEqual(demo_run.program_name(["/x/site_node", "--config", "deploy/sites/alice.toml"]), "alice")
        self.assertEqual(demo_run.program_name(["/x/world_server", "--config", "w.toml"]), "world")
        self.assertEqual(demo_run.program_name(["/x/viewer", "--config", "v.toml"]), "viewer")

    def test_measures_processor_time_per_metaframe(self):
        begin, end = mock.Mock(), mock.Mock()
        begin.time, end.time = 0.0, 10.0
        begin.cpu_s, end.cpu_s = {"alice": 1.0, "world": 2.0}, {"alice": 4.0, "world": 8.0}
        begin.waited, end.waited = {"alice": {"1": 1.0}, "world": {}}, {"alice": {"1": 1.5, "2": 1.0}, "world": {}}
        end.memory = {"alice": {}, "world": {}}
        used = demo_run.used_between(begin, end, {"alice": 20.0, "bob": 30.0})
        self.assertAlmostEqual(used["alice"]["processor_ms_per_metaframe"], 15.0)  # of its own metaframes
        self.assertAlmostEqual(used["alice"]["waiting_ms_per_metaframe"], 7.5)
        self.assertAlmostEqual(used["world"]["processor_ms_per_metaframe"], 12.0)  # of those of all sites
        self.assertIsNone(used["world"]["waiting_ms_per_metaframe"])  # the kernel did not count it
        self.assertAlmostEqual(used["world"]["core_share"], 0.6)

    def test_reads_rates_from_the_demos_table(self):
        lines = ["alice          29.5 metaframes/s  published   15.5   70.8   0.93  0 inc 0 late 0 rate 0 bad    587",
                 "world             120.0 steps/s    touched   25.2   88.6", "alice          30.5 metaframes/s  published"]
        self.assertEqual(demo_run.site_rates(lines), {"alice": [29.5, 30.5]})

    def test_reads_start_times_from_logs(self):
        with tempfile.TemporaryDirectory() as output:
            for name, line in (("world", "2026-11-23T15:00:01.500 info world_server running world=demo-1 objects=3"),
                               ("viewer", "2026-11-23T15:00:03.250 info viewer person_shown site=alice triangles=9 cameras=8"),
                               ("alice", "nothing")):
                with open(os.path.join(output, name + ".log"), "w", encoding="utf-8") as file:
                    file.write("some first line\n" + line + "\n")
            begin = demo_run.log_time("2026-11-23T15:00:00.000 x")
            started = {"world": begin, "viewer": begin, "alice": begin, "bob": begin}
            self.assertEqual(demo_run.start_seconds(output, started), {"world": 1.5, "alice": 3.25})

    def test_takes_medians_of_numbers_inside_dictionaries(self):
        runs = [{"a": 1, "b": {"c": 5.0}, "d": "x", "e": None}, {"a": 3, "b": {"c": 1.0}, "d": "x", "e": 2.0}, {"a": 2, "b": {"c": 2.0}, "d": "x"}]
        self.assertEqual(demo_run.median_of(runs), {"a": 2, "b": {"c": 2.0}, "d": "x", "e": 2.0})
        self.assertEqual(demo_run.median_of([{"a": None}, {"a": {"b": 1}}, {"a": {"b": 3}}]), {"a": {"b": 2}})


FAKE_DEMO = """#!/usr/bin/env python3
import json, os, signal, subprocess, sys, time
if "--help" in sys.argv:
    print("--table-seconds")
    sys.exit(0)
assert sys.argv[sys.argv.index("--table-seconds") + 1] == "1"
output = sys.argv[sys.argv.index("--output") + 1]
behaviour = os.environ["FAKE_DEMO"]
sleeper = os.path.join(os.path.dirname(os.path.abspath(__file__)), "world_server")
child = subprocess.Popen([sleeper, "--config", "w.toml"], stdout=subprocess.PIPE)
child.stdout.readline()  # while a program is being replaced by exec, /proc shows no command line
stopped = []
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda *_: stopped.append(1))
with open(os.path.join(output, "pid"), "w") as file:
    file.write(str(child.pid))
for second in range(1, 4 if behaviour == "works" else 10000):
    print("program  rate", flush=True)
    print("alice    30.0 metaframes/s", flush=True)
    print(f"time         {second} of 3 s", flush=True)
    time.sleep(0.15)
    if stopped: break
child.terminate()
child.wait()
if not stopped:
    with open(os.path.join(output, "report.json"), "w") as file:
        json.dump({"seconds": 3}, file)
sys.exit(0)
"""


class RunsADemo(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for name, text in (("demo", FAKE_DEMO), ("world_server", "#!/bin/sh\nexec python3 -c 'import time; print(1, flush=True); time.sleep(600)' \"$@\"\n")):
            path = os.path.join(self.folder.name, name)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            os.chmod(path, 0o755)
        self.output = os.path.join(self.folder.name, "out")

    def test_measures_the_programs_of_the_demo(self):
        with mock.patch.dict(os.environ, FAKE_DEMO="works"), mock.patch.object(demo_run, "program_name", return_value="world"):
            result_of_run = demo_run.run(os.path.join(self.folder.name, "demo"), self.folder.name, self.output, 3)
        self.assertEqual(result_of_run["report"], {"seconds": 3})
        self.assertEqual(result_of_run["rates"], {"alice": 30.0})
        self.assertIn("world", result_of_run["programs"])
        self.assertGreater(result_of_run["programs"]["world"]["memory_mb"]["resident"], 1.0)

    def test_leaves_no_process_when_interrupted(self):
        script = (f"import sys; sys.path.insert(0, {os.path.join(ROOT, 'bench')!r})\nimport demo_run\n"
                  "demo_run.program_name = lambda command: 'world'\n"
                  f"demo_run.run({os.path.join(self.folder.name, 'demo')!r}, {self.folder.name!r}, {self.output!r}, 3)\n")
        runner = subprocess.Popen([sys.executable, "-c", script], env={**os.environ, "FAKE_DEMO": "hangs"}, stderr=subprocess.DEVNULL)
        pid_file = os.path.join(self.output, "pid")
        deadline = time.monotonic() + 30
        while not (os.path.exists(pid_file) and os.path.getsize(pid_file)) and time.monotonic() < deadline:
            time.sleep(0.02)
        with open(pid_file, encoding="ascii") as file:
            child = int(file.read())
        runner.send_signal(signal.SIGINT)
        runner.wait(30)
        self.assertFalse(os.path.exists(f"/proc/{child}"))


class ReadmeTable(unittest.TestCase):
    def test_names_machine_score_and_commit(self):
        text = readme_table.demo_table(result())
        for part in ("Some CPU with 2 cores", "machine score 100 on one core and 90 on all", "commit 0123456", "6 of 1140", "12.3 and 12.3",
                     "66 ms; 139 ms", "not counted"):
            self.assertIn(part, text)
        self.assertNotIn("not quiet", text)

    def test_prefers_start_times_that_programs_report(self):
        self.assertIn("until the world server runs", readme_table.demo_table(result()))
        kept = result()
        for name, seconds in (("world", 0.25), ("viewer", 1.5)):
            kept["figures"]["report"][name]["first_output_s"] = seconds
        self.assertIn("first picture | not counted and not counted, 0.2, 1.5 s |", readme_table.demo_table(kept))

    def test_reports_the_quality_that_the_viewer_gave_up(self):
        kept = result()
        self.assertNotIn("allows itself", readme_table.demo_table(kept))
        kept["figures"]["report"]["viewer"].update(max_frames_per_s=30.0, scale=0.75, shadows=0.0)
        self.assertIn("| 30; 75% of the picture's width and height, without shadows |", readme_table.demo_table(kept))

    def test_reports_a_machine_that_was_not_quiet(self):
        self.assertIn("**not quiet**", readme_table.demo_table(result(quiet=False)))

    def test_check_fails_if_a_table_differs_from_the_newest_files(self):
        with tempfile.TemporaryDirectory() as folder:
            readme, overview = os.path.join(folder, "README.md"), os.path.join(folder, "overview.md")
            files = []
            for i, date in enumerate(("2026-11-23T15:00Z", "2026-11-24T09:00Z")):
                kept = copy.deepcopy(result(date))
                kept["commit"] = f"commit{i}"
                files.append(os.path.join(folder, f"{2 - i}-demo.json"))  # the name does not tell which is newest
                with open(files[-1], "w", encoding="utf-8") as file:
                    json.dump(kept, file)
            with open(readme, "w", encoding="utf-8") as file:
                file.write("head\n<!-- demo -->\n<!-- /demo -->\nrest\n")
            with open(overview, "w", encoding="utf-8") as file:
                file.write("<!-- parts --><!-- /parts -->\n<!-- recordings --><!-- /recordings -->\n")
            with mock.patch.object(readme_table, "README", readme), mock.patch.object(readme_table, "OVERVIEW", overview), \
                    mock.patch.object(readme_table, "results_files", side_effect=lambda kind="demo.json": files if kind == "demo.json" else []):
                self.assertIsNotNone(readme_table.check())
                readme_table.renew_pages(files[0])
                self.assertIsNotNone(readme_table.check())
                readme_table.renew_pages(files[1])
                self.assertIsNone(readme_table.check())
                with open(readme, encoding="utf-8") as file:
                    text = file.read()
                self.assertTrue(text.startswith("head\n") and text.endswith("rest\n"))
                with open(readme, "w", encoding="utf-8") as file:
                    file.write(text.replace("66 ms", "65 ms"))
                self.assertIsNotNone(readme_table.check())

    def test_reads_machine_and_score_from_a_tables_first_line(self):
        old = "2026-11-22T00:47Z, Intel(R) Xeon(R) Processor, 2 cores, c++ 12.2.0"
        self.assertEqual(readme_table.measured_on(old), "Intel(R) Xeon(R) Processor, score not measured, 2026-11-22")
        new = "2026-11-24T00:47Z, Some CPU, machine score 98.6, 2 cores, c++ 12.2.0"
        self.assertEqual(readme_table.measured_on(new), "Some CPU, score 99, 2026-11-24")

    def test_takes_the_latest_measurement_whatever_its_name(self):
        with tempfile.TemporaryDirectory() as folder:
            files = []
            for name, date in (("b", "2026-11-23T01:48Z"), ("a", "2026-11-23T16:00Z")):
                files.append(os.path.join(folder, f"2026-11-23-{name}.csv"))
                with open(files[-1], "w", encoding="utf-8") as file:
                    file.write(f"# {date}, CPU {name}, 2 cores\nkey\n{name}\n")
            with mock.patch.object(readme_table, "results_files", return_value=files):
                rows, where = readme_table.newest_rows("x.csv")
        self.assertEqual((rows[0]["key"], where), ("a", "CPU a, score not measured, 2026-11-23"))

    def test_reads_the_text_that_renew_put_between_markers(self):
        with tempfile.NamedTemporaryFile("w", suffix=".md") as page:
            page.write("a\n<!-- x -->\nold\n<!-- /x -->\nb\n")
            page.flush()
            page_table.renew(page.name, "x", "line 1\nline 2")
            self.assertEqual(page_table.between(page.name, "x"), "line 1\nline 2")
            self.assertIsNone(page_table.between(page.name, "y"))


class Whole(unittest.TestCase):
    def kept(self, a, b):
        return {"a": "aaaaaaa", "b": "bbbbbbb", "seconds": 20, "score": None, "date": "2026-11-23T15:00Z", "machine": "Some CPU", "cores": 2,
                "runs": {"a": a, "b": b}}

    def run_with(self, ms, others=0.0):
        figures = copy.deepcopy(result()["figures"])
        figures["others_share"] = others
        figures["report"]["viewer"].update(pairs_shown=1000, pairs_skipped=10)
        figures["programs"]["world"]["processor_ms_per_metaframe"] = ms
        return figures

    def test_prints_the_ratio_of_medians(self):
        text = whole.table(self.kept([self.run_with(ms) for ms in (10.0, 30.0, 12.0)], [self.run_with(ms) for ms in (6.0, 1.0, 9.0)]))
        self.assertIn("| world: processor time per metaframe | 12.0 ms | 6.0 ms | 0.50 |", text)
        self.assertIn("all runs quiet", text)

    def test_counts_runs_that_were_not_quiet_and_leaves_gaps_without_a_measurement(self):
        old = self.run_with(10.0, others=0.2)
        old["programs"]["world"]["waiting_ms_per_metaframe"] = None
        text = whole.table(self.kept([old], [self.run_with(5.0)]))
        self.assertIn("**1 runs not quiet**", text)
        self.assertIn("| world: waiting per metaframe | not measured | 1.0 ms |  |", text)


class Instructions(unittest.TestCase):
    def test_reads_the_total_of_callgrind(self):
        self.assertEqual(instructions.collected("==1== Events    : Ir\n==1== Collected : 335736149\n==1==\n"), 335736149)
        self.assertIsNone(instructions.collected("==1== Collected : 0\n"))  # nothing was counted
        self.assertIsNone(instructions.collected("==1== error\n"))

    def test_a_processor_that_valgrind_does_not_know(self):
        unknown = "vex amd64->IR: unhandled instruction bytes: 0xF 0x1 0xF9 0x48"
        self.assertEqual(instructions.unknown_instruction(f"==1== a\n{unknown}\n==1== b\n"), unknown)
        self.assertIsNone(instructions.unknown_instruction("==1== Process terminating with default action of signal 4 (SIGILL)\n"))
        for output, code in ((unknown, 4), ("==1== error\n", 3)):  # a crash of our own is no excuse
            with mock.patch.object(instructions, "run", return_value=mock.Mock(returncode=-4, stdout=output)), \
                    contextlib.redirect_stderr(io.StringIO()), self.assertRaises(SystemExit) as ended:
                instructions.count("site", "program", "folder", 8)
            self.assertEqual(ended.exception.code, code)

    def test_fails_above_fifteen_percent_in_any_stage(self):
        kept = {"site": 100e6, "world": 100e6, "viewer": 100e6}
        for ratio, expected in ((0.5, True), (1.149, True), (1.151, False)):
            lines, within = instructions.compare(kept, {**kept, "world": ratio * 100e6})
            self.assertEqual(within, expected)
            self.assertEqual(sum("MORE THAN" in line for line in lines), 0 if expected else 1)

    def exit_code(self, kept, now):
        content = {"kept": {"some processor": {"date": "2026-11-23", "per_metaframe": kept}} if kept else {}}
        with mock.patch.object(instructions, "load", return_value=content), mock.patch.object(instructions, "measure", return_value=now), \
                mock.patch.object(instructions, "processor", return_value="some processor"), mock.patch.object(sys, "argv", ["instructions"]), \
                mock.patch("builtins.print"):
            try:
                instructions.main()
            except SystemExit as end:
                return end.code
        return 0

    def test_exits_with_the_codes_of_its_help(self):
        kept = {"site": 100e6, "world": 100e6, "viewer": 100e6}
        self.assertEqual(self.exit_code(kept, kept), 0)
        self.assertEqual(self.exit_code(kept, {**kept, "viewer": 120e6}), 1)
        self.assertEqual(self.exit_code(None, kept), 1)

    def test_keeps_figures_of_every_stage(self):
        for kept in instructions.load()["kept"].values():
            self.assertEqual(set(kept["per_metaframe"]), set(instructions.STAGES))


if __name__ == "__main__":
    unittest.main()
