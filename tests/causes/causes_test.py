#!/usr/bin/env python3
"""Tests the runner of the table of causes with rows that must fail."""

import os
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import page
import run
import table

ROW = {"id": '"a_row"', "program": '"viewer"', "cause": '"The file is missing."', "cure": '"Give its path."', "command": '"echo no file; exit 3"',
       "exit": "3", "message": '"no file"'}


def read(*rows, text=""):
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "area.toml")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(text + "".join("[[case]]\n" + "".join(f"{key} = {value}\n" for key, value in row.items()) for row in rows))
        return table.read_files([file])


class Table(unittest.TestCase):
    def refused(self, reason, *rows, text=""):
        with self.assertRaises(table.TableError) as caught:
            read(*rows, text=text)
        self.assertIn(reason, str(caught.exception))

    def test_accepts_a_good_row(self):
        case, = read(ROW)
        self.assertEqual((case.area, case.exit, case.messages), ("area", 3, ("no file",)))

    def test_refuses_unknown_keys_and_tables(self):
        self.refused("unknown key 'exti'", ROW | {"exti": "1"})
        self.refused("unknown table", ROW, text="[[cause]]\nid = 1\n")

    def test_refuses_two_rows_of_one_id(self):
        self.refused("this id is also in area.toml", ROW, ROW)

    def test_refuses_what_is_no_sentence(self):
        self.refused("cause: must be sentences", ROW | {"cause": '"the file is missing"'})
        self.refused("cure is missing", ROW | {"cure": '""'})

    def test_refuses_rows_that_nothing_checks(self):
        for key in ("command", "exit", "message"):
            self.refused(f"{key}", {k: v for k, v in ROW.items() if k != key})
        self.refused("at least 4 characters", ROW | {"message": '["no file", "a"]'})
        self.refused("exclude each other", ROW | {"by_hand": '"It needs a burning host."'})

    def test_refuses_wrong_types_and_programs(self):
        self.refused("exit: wrong type", ROW | {"exit": '"3"'})
        self.refused("program: must be one of", ROW | {"program": '"veiwer"'})
        self.refused("area.toml", text="[[case]\n")


def is_running(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
            return stat.read().split()[2] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


class Run(unittest.TestCase):
    def wrong(self, **changes):
        case, = read(ROW | {key: repr(value) if isinstance(value, str) else str(value) for key, value in changes.items()})
        return run.run_case((case, "/bin", "/nonexistent"))[1]

    def test_passes_what_behaves_as_its_row_says(self):
        self.assertEqual(self.wrong(), [])

    def test_finds_another_exit_code(self):
        self.assertEqual(self.wrong(exit=2), ["exit code 3, must be 2"])

    def test_finds_a_missing_message(self):
        self.assertEqual(self.wrong(message="no such file"), ["message is missing: no such file"])

    def test_reads_both_streams(self):
        self.assertEqual(self.wrong(command="echo no; echo no file >&2; exit 3"), [])

    def test_begins_in_an_empty_folder_with_the_prepared_files(self):
        self.assertEqual(self.wrong(prepare="touch a", command="echo no file $(ls -A); exit 3", message="no file a"), [])

    def test_finds_a_prepare_that_fails(self):
        self.assertEqual(self.wrong(prepare="false; true"), ["prepare ended with 1"])

    def test_leaves_no_process_behind(self):
        case, = read(ROW | {"command": "'sleep 1000 >/dev/null 2>&1 & echo no file $!; exit 3'"})
        _, wrong, output, _ = run.run_case((case, "/bin", "/nonexistent"))
        self.assertEqual(wrong, [])
        pid = output.split()[-1]
        deadline = time.monotonic() + 20  # the kernel ends it when it gets to run
        while is_running(pid) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertFalse(is_running(pid))

    def test_ends_what_does_not_end_by_itself(self):
        run.LIMIT_S = 0.2
        try:
            self.assertIn("does not end by itself", self.wrong(command="echo no file; sleep 1000")[0])
        finally:
            run.LIMIT_S = 60

    def test_looks_up_messages_that_no_test_can_provoke(self):
        good = {k: v for k, v in ROW.items() if k not in ("command", "exit")} | {"by_hand": '"It needs a burning host."'}
        cases = read(good | {"message": '"niceness_refused wanted="'}, good | {"id": '"b"', "message": '"no such text anywhere"'})
        self.assertEqual([case.id for case, *_ in run.check_by_hand(cases)], ["b"])


class Page(unittest.TestCase):
    def test_shows_each_row_and_wraps_long_ones(self):
        text = page.page(read(ROW | {"cure": '"' + "Word " * 50 + 'end."'}))
        self.assertIn("## viewer\n\n### Area\n\n- `no file` (exit code 3)  \n  The file is missing.  \n  → Word", text)
        self.assertLessEqual(max(map(len, text.splitlines())), 145)


if __name__ == "__main__":
    unittest.main()
