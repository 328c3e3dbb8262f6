#!/usr/bin/env python3
"""Fails when two files define types of one name in one namespace: linked together, one's constructors and
destructors serve the other's objects (C++'s one definition rule), and no compiler or linker says so.

Types in functions, in other types and in unnamed namespaces belong to their file and are not looked at. Takes the
repository root; prints 'file:line: why'.
"""

import collections
import pathlib
import re
import sys

FOLDERS = ("engine", "store", "proto", "cli", "indexer", "server", "client", "datasets", "bench", "tests")

# Comments, raw strings, strings, characters (not the ' of 10'000) and preprocessor lines hold no definitions.
NO_CODE = re.compile(
    r"""//[^\n]*|/\*.*?\*/|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'"""
    r"""|^[ \t]*\#(?:\\\n|[^\n])*""",
    re.DOTALL | re.MULTILINE,
)
NAMESPACE = re.compile(r"(?:inline\s+)?namespace\b\s*([\w:]*)\s*$")
TYPE = re.compile(
    r"(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(?:\[\[[^\]]*\]\]\s*|alignas\s*\([^)]*\)\s*)*"
    r"(\w[\w:]*\s*(?:<[^{]*?>)?)\s*(?:final\s*)?(?::[^:].*)?$",
    re.DOTALL,
)


def without_template(head):
    """`head` less the `template <...>` that it may begin with."""
    head = head.strip()
    while head.startswith("template"):
        depth = 0
        for at, character in enumerate(head):
            depth += {"<": 1, ">": -1}.get(character, 0)
            if character == ">" and depth == 0:
                head = head[at + 1 :].strip()
                break
        else:
            return head
    return head


def types_of(text):
    """(line, qualified name) of each type that `text` defines at namespace scope."""
    text = NO_CODE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)
    scopes = []  # a namespace's name, or None for anything else
    head = 0
    for brace in re.finditer(r"[{};]", text):
        if brace.group() == "{":
            words = without_template(text[head : brace.start()])
            namespace = NAMESPACE.search(words)
            found = TYPE.match(words)
            if found and None not in scopes:
                name = re.sub(r"\s+", "", found.group(1))
                yield text.count("\n", 0, brace.start()) + 1, "::".join([*scopes, name])
            # An unnamed namespace is closed to us, as a function's body is.
            scopes.append((namespace.group(1) or None) if namespace else None)
        elif brace.group() == "}" and scopes:
            scopes.pop()
        head = brace.end()


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    places = collections.defaultdict(list)
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.[ch]pp")):
            for line, name in types_of(path.read_text(encoding="utf-8")):
                places[name].append((path.relative_to(root).as_posix(), line))
    complaints = 0
    for name, defined in sorted(places.items()):
        first = defined[0]
        for path, line in defined[1:]:
            if path == first[0]:
                continue  # one file: the compiler sees both
            print(f"{path}:{line}: {name} is also defined at {first[0]}:{first[1]}")
            complaints += 1
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
