#!/usr/bin/env python3
"""docs/landmarkdb.service is a unit that systemd takes, of a server that strangers cannot reach."""

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

UNIT = "docs/landmarkdb.service"
BIN = os.environ.get("LANDMARKDB_BIN", "build/release/bin")


def exec_start():
    with open(UNIT, encoding="utf-8") as unit:
        lines = [line for line in unit if line.startswith("ExecStart=")]
    assert len(lines) == 1, lines
    return shlex.split(lines[0].removeprefix("ExecStart="))


class ServiceUnit(unittest.TestCase):
    def test_listens_on_no_port_without_a_token(self):
        words = exec_start()
        if "--token-file" not in words:
            self.assertEqual(words[words.index("--listen") + 1], "none")

    def test_gives_the_server_options_that_it_has(self):
        with tempfile.TemporaryDirectory() as folder:
            words = [os.path.join(BIN, "landmarkdb-server")] + exec_start()[1:]
            words[words.index("--db") + 1] = os.path.join(folder, "missing.db")
            words[words.index("--unix") + 1] = os.path.join(folder, "s")
            ran = subprocess.run(words, capture_output=True, text=True, timeout=60)
            self.assertEqual(ran.returncode, 7, ran.stderr)
            self.assertIn("missing.db", ran.stderr)

    def test_is_taken_by_systemd(self):
        if shutil.which("systemd-analyze") is None:
            self.skipTest("systemd-analyze is not installed")
        with open(UNIT, encoding="utf-8") as unit:
            # It looks for the program, too, which is not installed here.
            text = unit.read().replace(exec_start()[0], "/bin/true")
        with tempfile.TemporaryDirectory() as folder:
            copy = os.path.join(folder, os.path.basename(UNIT))
            with open(copy, "w", encoding="utf-8") as file:
                file.write(text)
            ran = subprocess.run(
                ["systemd-analyze", "verify", "--man=no", copy],
                capture_output=True, text=True, timeout=60)
        # Units of the machine itself may be at fault, too: only what is said of ours counts.
        ours = [line for line in ran.stderr.splitlines() if "landmarkdb" in line]
        self.assertEqual(ours, [], ran.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
