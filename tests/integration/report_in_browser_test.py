"""The pages of `landmarkdb query --report` hold in a browser: they draw, say nothing to the console, fetch nothing.

Makes two small places, indexes one of them, and asks three questions: one that is localized, one that is ambiguous
(the place is stored twice) and one that is not found (a frame of the other place). Exit status 77, skipped, where
no Chromium is installed (Debian's package `chromium`).
"""

import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

BIN = pathlib.Path(os.environ["LANDMARKDB_BIN"])
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
LIMIT_S = 120
QUERY_COLOUR = (0x00, 0x72, 0xB2)  # --query of web/report.css, light
INLIER_COLOUR = (0x00, 0x80, 0x60)
WIDTH, HEIGHT = 1280, 1000
# Counts, once all is loaded, what the page asked anyone for.
COUNTER = (
    "<script>window.addEventListener('load', () => { document.documentElement.dataset.fetched ="
    " performance.getEntriesByType('resource').length; });</script>"
)


def run(program, *arguments, ok=(0,)):
    done = subprocess.run([BIN / program, *arguments], capture_output=True, text=True, timeout=LIMIT_S, check=False)
    if done.returncode not in ok:
        raise AssertionError(f"{program} {arguments} ended with {done.returncode}: {done.stderr}{done.stdout}")
    return done


def browse(page, *arguments):
    """What Chromium prints on both streams after it opened the page."""
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run(
            [
                BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
                "--disable-background-networking", "--disable-component-update", "--disable-extensions",
                "--disable-dev-shm-usage", "--enable-logging=stderr", "--virtual-time-budget=8000",
                f"--user-data-dir={profile}", f"--window-size={WIDTH},{HEIGHT}", *arguments, page.as_uri(),
            ],
            capture_output=True, text=True, timeout=LIMIT_S, check=True,
        )  # fmt: skip
    return done.stdout, done.stderr


def pixels(path):
    """Width, height and rows of (r, g, b) of an 8-bit PNG without interlacing, which is what Chromium writes."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
            assert (depth, interlace) == (8, 0) and colour in (2, 6)
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    bytes_a_pixel = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(packed), width * bytes_a_pixel
    rows, before = [], bytearray(stride)
    for y in range(height):
        start = y * (stride + 1)
        row = bytearray(raw[start + 1 : start + 1 + stride])
        unfilter(raw[start], row, before, bytes_a_pixel)
        rows.append([tuple(row[i : i + 3]) for i in range(0, stride, bytes_a_pixel)])
        before = row
    return width, height, rows


def unfilter(kind, row, before, step):
    """Undoes one of PNG's five row filters in place."""
    for i in range(len(row)):
        left = row[i - step] if i >= step else 0
        up, corner = before[i], before[i - step] if i >= step else 0
        if kind == 1:
            row[i] = (row[i] + left) & 255
        elif kind == 2:
            row[i] = (row[i] + up) & 255
        elif kind == 3:
            row[i] = (row[i] + (left + up) // 2) & 255
        elif kind == 4:
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda value: abs(guess - value))
            row[i] = (row[i] + nearest) & 255


def count_near(rows, colour, tolerance=24):
    return sum(all(abs(a - b) <= tolerance for a, b in zip(p, colour)) for row in rows for p in row)


def scans(folder):
    arguments = [str(path) for path in sorted(folder.glob("station-*.ply"))]
    for path in sorted(folder.glob("station-*.pose.txt")):
        arguments += ["--pose", str(path), "--viewpoint", "0,0,0"]
    return [*arguments, "--up", "0,0,1"]


class ReportInBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        for name, kind in (("office", "office"), ("elsewhere", "temple")):
            run("landmarkdb-generate", "--quiet", "place", "--type", kind, "--seed", "1", "--points", "150000",
                "--queries", "4", "--out", str(cls.folder / name))  # fmt: skip
        for db, names in (("one.db", ["office"]), ("two.db", ["office", "<b>copy"])):
            for name in names:
                run("landmarkdb-indexer", "--db", str(cls.folder / db), "--quiet", "add", name,
                    *scans(cls.folder / "office"))  # fmt: skip
        cls.addresses = {db: cls.serve(db) for db in ("one.db", "two.db")}

    @classmethod
    def serve(cls, db):
        socket = cls.folder / (db + ".sock")
        server = subprocess.Popen(
            [BIN / "landmarkdb-server", "--db", cls.folder / db, "--listen", "none", "--unix", socket],
            stderr=subprocess.DEVNULL,
        )
        cls.addClassCleanup(server.wait, timeout=LIMIT_S)
        cls.addClassCleanup(server.terminate)
        until = time.monotonic() + LIMIT_S
        while run("landmarkdb", "--server", f"unix:{socket}", "health", ok=(0, 1, 8)).returncode != 0:
            assert time.monotonic() < until, "the server does not answer"
            time.sleep(0.1)
        return f"unix:{socket}"

    def report(self, db, queries, status):
        """The page of the first of these queries that ends with this exit status."""
        for query in queries:
            page = self.folder / f"{db}-{query.stem}-{status}.html"
            done = run("landmarkdb", "--server", self.addresses[db], "query", str(query), "--min-confidence", "0.3",
                       "--report", str(page), ok=(0, 3, 4))  # fmt: skip
            if done.returncode == status:
                return page
        self.fail(f"no query of {len(queries)} ended with {status}; the last said: {done.stdout}")

    def look_at(self, page, verdict):
        watched = page.with_suffix(".watched.html")
        watched.write_text(page.read_text(encoding="utf-8").replace("</head>", COUNTER + "</head>"), encoding="utf-8")
        dom, messages = browse(watched, "--dump-dom")
        self.assertNotIn("CONSOLE", messages)
        self.assertIn(verdict, dom)
        self.assertIn('data-drawn="yes"', dom)
        self.assertIn('data-fetched="0"', dom)
        self.assertFalse(re.search(r"<b>copy", dom), "a scene's name became a tag")
        picture = page.with_suffix(".png")
        browse(page, f"--screenshot={picture}")
        if keep := os.environ.get("LANDMARKDB_KEEP_REPORTS"):
            shutil.copy(picture, keep)
            shutil.copy(page, keep)
        width, height, rows = pixels(picture)
        self.assertEqual((width, height), (WIDTH, HEIGHT))
        self.assertGreater(count_near(rows, QUERY_COLOUR), 1000, "the cloud is not drawn")
        return rows

    def test_a_place_that_was_found(self):
        page = self.report("one.db", sorted((self.folder / "office").glob("query-*.ply")), 0)
        rows = self.look_at(page, "Localized in")
        self.assertGreater(count_near(rows, INLIER_COLOUR), 50, "no inlier pair is drawn")

    def test_a_place_that_is_there_twice(self):
        page = self.report("two.db", sorted((self.folder / "office").glob("query-*.ply")), 4)
        self.look_at(page, "poses explain the cloud about equally well")

    def test_a_place_that_is_not_there(self):
        page = self.report("one.db", sorted((self.folder / "elsewhere").glob("query-*.ply")), 3)
        self.look_at(page, "Not found")


if __name__ == "__main__":
    if BROWSER is None:
        print("skipped: no chromium; apt-get install chromium")
        sys.exit(77)
    unittest.main()
