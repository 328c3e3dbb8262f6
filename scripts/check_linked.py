#!/usr/bin/env python3
"""Fails when a program needs a library that a server must not bring along, itself or through another library.

PCL's io, visualization, recognition and surface parts bring VTK: 471 MB to install instead of 110 MB. The GPL
libraries would bind our licence. Takes the program's path.
"""

import re
import subprocess
import sys

REFUSED = re.compile(
    r"lib(pcl_(io|visualization|recognition|surface|people|apps|outofcore)|vtk|Qt[56]|OpenNI|GL\.|X11|"
    r"qhull|CGAL|gmp|mpfr|fftw3|gsl|readline)"
)


def needed_itself(program):
    """What the program names in its own dynamic section."""
    text = subprocess.run(["readelf", "-d", program], check=True, capture_output=True, text=True).stdout
    return re.findall(r"\(NEEDED\).*\[(.+)\]", text)


def needed_in_all(program):
    """What the loader brings in for it."""
    text = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    return [line.split()[0] for line in text.splitlines() if line.strip()]


def main():
    program = sys.argv[1]
    names = needed_itself(program)
    if not any(name.startswith("libc.so") for name in names):
        print(f"{program}: its list of needed libraries does not name libc; readelf was not understood")
        return 1
    bad = sorted({name for name in names + needed_in_all(program) if REFUSED.match(name.rsplit("/", 1)[-1])})
    for name in bad:
        print(f"{program}: needs {name}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
