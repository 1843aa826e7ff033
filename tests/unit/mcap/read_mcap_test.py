#!/usr/bin/env python3
"""Reads files of core/mcap with a reader that was written from the specification: read_mcap_test.py WRITE_MCAP."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support/mcap"))
import read_mcap

WRITER = sys.argv.pop()


class ReadMcap(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.file = os.path.join(self.folder.name, "a.mcap")

    def written(self, kind):
        lines = subprocess.run([WRITER, self.file, kind], check=True, capture_output=True, text=True).stdout.splitlines()
        with open(self.file, "rb") as stream:
            return lines, stream.read()

    def test_reads_every_message(self):
        for kind in ("whole", "repaired"):
            with self.subTest(kind):
                lines, data = self.written(kind)
                self.assertGreater(len(lines), 200)
                mcap = read_mcap.Mcap(data)
                self.assertEqual([json.loads(line) for line in read_mcap.lines(mcap)], [json.loads(line) for line in lines])
                self.assertEqual(mcap.metadata, [("atrium", {"world": "w"})])
                self.assertEqual(mcap.channels[1], (1, "b", "cdr", {"key": "value"}))
                os.remove(self.file)

    def test_finds_every_changed_byte(self):
        # The reader checks so much that it notices any change: else the test above would prove little.
        _, data = self.written("whole")
        unnoticed = 0
        for at in range(0, len(data), 499):
            changed = data[:at] + bytes([data[at] ^ 0x20]) + data[at + 1:]
            try:
                mcap = read_mcap.Mcap(changed)
                unnoticed += list(read_mcap.lines(mcap)) == list(read_mcap.lines(read_mcap.Mcap(data)))
            except (read_mcap.McapError, UnicodeDecodeError):
                pass
        self.assertLess(unnoticed, 5)


if __name__ == "__main__":
    unittest.main()
