#!/usr/bin/env python3
"""Prints 'N passed, N failed' (', N skipped' where some were) from a JUnit file of ctest.

The names of the failed tests come first. Exit status 1 when a test failed or none passed.
"""

import sys
import xml.etree.ElementTree as ElementTree


def count(path):
    """Passed, skipped and the names of the failed tests; ctest's word for the first is 'run'."""
    passed, skipped, failed = 0, 0, []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        status = case.get("status")
        why_not_run = getattr(case.find("skipped"), "attrib", {}).get("message", "")
        if status == "run":
            passed += 1
        elif status == "disabled" or "SKIP" in why_not_run:
            skipped += 1
        else:
            failed.append(case.get("name") + (f" ({why_not_run})" if why_not_run else ""))
    return passed, skipped, failed


def main():
    try:
        passed, skipped, failed = count(sys.argv[1])
    except (OSError, ElementTree.ParseError) as error:
        print(f"summarise_tests: ctest left no results: {error}", file=sys.stderr)
        return 1
    for name in failed:
        print(f"failed: {name}")
    print(f"{passed} passed, {len(failed)} failed" + (f", {skipped} skipped" if skipped else ""))
    return 1 if failed or passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
