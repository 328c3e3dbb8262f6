#!/usr/bin/env python3
"""Fails when a file includes what its folder may not see. Takes the repository root; prints 'file:line: why'."""

import pathlib
import re
import sys

BASE = ["engine/base"]
TYPES = BASE + ["engine/types"]
GEOMETRY = TYPES + ["engine/geometry"]
CLOUD = GEOMETRY + ["engine/cloud"]
RETRIEVAL = CLOUD + ["engine/features", "engine/matching", "engine/registration", "engine/retrieval"]

# Folder -> what it may include besides itself. The longest folder that fits a file counts.
ALLOWED = {
    "proto": [],
    "schema": [],
    "web": [],
    "engine/base": [],
    "engine/types": BASE,
    "engine/geometry": TYPES,
    "engine/cloud": GEOMETRY,
    "engine/features": CLOUD,
    "engine/matching": CLOUD,
    "engine/registration": CLOUD,
    "engine/mono": CLOUD,
    "engine/servo": GEOMETRY + ["engine/mono"],
    "engine/retrieval": RETRIEVAL,
    "store": ["schema"] + TYPES,
    "cli": GEOMETRY,
    "indexer": ["cli", "store", "engine"],
    "server": ["cli", "proto", "store", "engine"],
    "client": ["cli", "proto"] + CLOUD,
    "datasets": ["cli"] + CLOUD,
    "bench": ["cli", "proto", "store", "engine", "indexer", "server", "client", "datasets", "tests/support"],
    "tests": ["cli", "proto", "store", "engine", "indexer", "server", "client", "datasets", "bench"],
}

# Third-party header -> where it may be included. A header file of ours hides PCL, FLANN and SQLite altogether.
IN_SOURCES_ONLY = re.compile(r"pcl/|flann/|sqlite3\.h$")
PLACES = [
    (re.compile(r"sqlite3\.h$"), ("store/", "tests/")),
    (re.compile(r"pcl/(io|visualization|recognition|surface)/"), ()),  # they bring VTK: 361 MB at run time
    (re.compile(r"boost/(asio|beast)"), ("server/", "client/", "tests/")),
    (re.compile(r"google/protobuf/"), ("proto/", "server/", "client/", "tests/")),
]

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^">\n]+)[">]', re.MULTILINE)


def under(path, folder):
    return path == folder or path.startswith(folder + "/")


def folder_of(path):
    """The longest folder of ALLOWED that holds `path`, or None."""
    return max((f for f in ALLOWED if under(path, f)), key=len, default=None)


def complaint(root, path, quote, header):
    """Why `path` may not include `header`, or None."""
    if quote == '"':
        if folder_of(header) is None or not ((root / header).exists() or header.endswith(".pb.h")):
            return f'"{header}" is no path from the repository root'
        home = folder_of(path)
        if not any(under(header, seen) for seen in [home] + ALLOWED[home]):
            return f'{home} may not include "{header}"'
        return None
    if IN_SOURCES_ONLY.match(header) and path.endswith(".hpp"):
        return f"<{header}> belongs in a .cpp file"
    for pattern, places in PLACES:
        if pattern.match(header) and not path.startswith(places):
            return f"<{header}> may be included in {', '.join(places) or 'no place'} only"
    return None


def complaints(root):
    for folder in sorted({f.split("/")[0] for f in ALLOWED}):
        for file in sorted((root / folder).rglob("*.[hc]pp")):
            path = file.relative_to(root).as_posix()
            if folder_of(path) is None:
                yield f"{path}:1: its folder is not in scripts/check_layers.py"
                continue
            text = file.read_text(encoding="utf-8")
            for match in INCLUDE.finditer(text):
                why = complaint(root, path, *match.groups())
                if why:
                    line = text.count("\n", 0, match.start()) + 1
                    yield f"{path}:{line}: {why}"


def main():
    found = list(complaints(pathlib.Path(sys.argv[1])))
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
