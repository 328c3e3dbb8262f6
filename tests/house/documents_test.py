"""The commands that README.md and docs/ print run as printed, and print what is printed below them.

A block of commands is tested when '<!-- tested -->' stands on the line before it. All tested blocks of a page run
one after another in one shell, in an empty folder, with our programs first on the PATH. A line of a 'text' block
that follows with '<!-- output -->' must appear in what they printed; numbers may differ, as times and the last
digits of a pose do.
"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("LANDMARKDB_BIN", ROOT / "build/release/bin"))
COMMANDS = re.compile(r"<!-- tested -->\n```sh\n(.*?)```", re.DOTALL)
OUTPUT = re.compile(r"<!-- output -->\n```text\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
NUMBER = re.compile(r"-?\d[\d.,e+-]*")
LIMIT_S = 240  # a page; the whole test has 300
# Jobs left in the background (a server) end with the shell.
SHELL_HEAD = "set -euo pipefail\ntrap 'kill $(jobs -p) 2> /dev/null || true; wait' EXIT\n"


def pages():
    return sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


def skeleton(line):
    """A line without its numbers and spacing."""
    return " ".join(NUMBER.sub("#", line).split())


def run_blocks(page):
    text = page.read_text(encoding="utf-8")
    script = SHELL_HEAD + "\n".join(COMMANDS.findall(text))
    environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
    with tempfile.TemporaryDirectory() as folder:
        shell = subprocess.Popen(
            ["bash", "-c", script],
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        try:
            printed, _ = shell.communicate(timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            os.killpg(shell.pid, signal.SIGKILL)  # its servers, too
            printed = shell.communicate()[0] + f"\n(not done after {LIMIT_S} s)"
    expected = [line for block in OUTPUT.findall(text) for line in block.splitlines() if line.strip()]
    return shell.returncode, printed, expected


class Documents(unittest.TestCase):
    def test_tested_blocks_run_and_print_what_the_page_says(self):
        tested = [page for page in pages() if COMMANDS.search(page.read_text(encoding="utf-8"))]
        self.assertTrue(tested)
        for page in tested:
            with self.subTest(page=page.name):
                status, printed, expected = run_blocks(page)
                self.assertEqual(0, status, printed)
                lines = {skeleton(line) for line in printed.splitlines()}
                missing = [line for line in expected if skeleton(line) not in lines]
                self.assertEqual([], missing, f"{page.name} promises these lines; printed was:\n{printed}")

    def test_links_between_pages_lead_somewhere(self):
        for page in pages():
            for target in LINK.findall(page.read_text(encoding="utf-8")):
                with self.subTest(page=page.name, target=target):
                    self.assertTrue((page.parent / target).exists())


if __name__ == "__main__":
    if not (BIN / "landmarkdb").exists():
        print(f"the programs are not in {BIN}")
        sys.exit(77)
    unittest.main()
