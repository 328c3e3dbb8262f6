#!/usr/bin/env python3
"""Fails when a *_test.cpp is in no CMakeLists.txt of its folder: a test that does not run is worse than none.

Takes the repository root; prints the files left out.
"""

import pathlib
import re
import sys


def sources_listed(folder):
    """The *_test.cpp names that landmarkdb_test(...) calls in the folder's CMakeLists.txt name."""
    lists = folder / "CMakeLists.txt"
    if not lists.exists():
        return set()
    text = re.sub(r"#[^\n]*", "", lists.read_text(encoding="utf-8"))
    calls = re.findall(r"landmarkdb_test\(([^)]*)\)", text)
    return {(folder / word).resolve() for call in calls for word in call.split() if word.endswith("_test.cpp")}


def unlisted(root):
    for test in sorted((root / "tests").rglob("*_test.cpp")):
        above = [parent for parent in test.parents if root / "tests" in [parent, *parent.parents]]
        if not any(test.resolve() in sources_listed(folder) for folder in above):
            yield test.relative_to(root).as_posix()


def main():
    missing = list(unlisted(pathlib.Path(sys.argv[1]).resolve()))
    for path in missing:
        print(f"{path}: in no landmarkdb_test(...)")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
