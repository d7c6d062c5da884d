#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Checks that every file has an SPDX line with the licence of its folder, or is
listed in REUSE.toml, and that LICENSES has the text of every licence.

licences.py ROOT          prints the files without the right licence
licences.py ROOT --add    adds the missing lines
"""
import os
import re
import subprocess
import sys
import tomllib

TAG = "SPDX-License-" "Identifier:"
FOLDERS = (("helpers/tetgen/", "AGPL-3.0-or-later"),
           ("helpers/wrap/", "GPL-3.0-or-later"),
           ("examples/", "BSD-2-Clause"),
           ("src/core/mesher/mesher.h", "BSD-2-Clause"))
DEFAULT = "LGPL-3.0-or-later"
FIRST_LINES = 4
IN_C = (".c", ".h", ".cpp", ".css", ".js", ".map")
IN_MARKDOWN = (".md",)
SKIPPED = ("build/", ".git/")


def files(root):
    """Tracked and new files, or all files if this is no git checkout."""
    try:
        out = subprocess.run(
            ["git", "-C", root, "ls-files", "-z", "--cached", "--others",
             "--exclude-standard"], capture_output=True, check=True).stdout
        names = [n.decode() for n in out.split(b"\0") if n]
    except (OSError, subprocess.CalledProcessError):
        names = [os.path.relpath(os.path.join(at, name), root)
                 for at, _, found in os.walk(root) for name in found]
    return sorted(n for n in names if not n.startswith(SKIPPED)
                  and os.path.isfile(os.path.join(root, n)))


def wanted(path):
    return next((licence for start, licence in FOLDERS
                 if path.startswith(start)), DEFAULT)


def listed(root):
    with open(os.path.join(root, "REUSE.toml"), "rb") as source:
        table = tomllib.load(source)
    return [(pattern, row["SPDX-License-Identifier"])
            for row in table["annotations"] for pattern in row["path"]]


def covers(pattern, path):
    """** also stands for no folder at all, and * for a name."""
    expression = re.escape(pattern).replace(r"\*\*/", "(.*/)?").replace(
        r"\*\*", ".*").replace(r"\*", "[^/]*")
    return re.fullmatch(expression, path) is not None


def found(root, path):
    """Licence of a file's SPDX line, or None."""
    try:
        with open(os.path.join(root, path), encoding="utf-8") as source:
            head = [source.readline() for _ in range(FIRST_LINES)]
    except UnicodeDecodeError:
        return None
    match = re.search(re.escape(TAG) + r"\s*([\w.+-]+)", "".join(head))
    return match.group(1) if match else None


def line_of(path, licence):
    if path.endswith(IN_C) and not path.endswith(".map"):
        return f"/* {TAG} {licence} */\n"
    if path.endswith(IN_MARKDOWN):
        return f"<!-- {TAG} {licence} -->\n"
    return f"# {TAG} {licence}\n"


def add(root, path, licence):
    name = os.path.join(root, path)
    with open(name, encoding="utf-8") as source:
        text = source.read()
    line = line_of(path, licence)
    if text.startswith("#!"):
        first, rest = text.split("\n", 1)
        text = first + "\n" + line + rest
    else:
        text = line + text
    with open(name, "w", encoding="utf-8") as to:
        to.write(text)


def main():
    root, adds = sys.argv[1], "--add" in sys.argv[2:]
    rows, bad, used = listed(root), 0, set()
    for path in files(root):
        is_licence = next((r for r in rows if covers(r[0], path)), None)
        licence = found(root, path) or (is_licence and is_licence[1])
        if licence is None and adds:
            add(root, path, wanted(path))
            licence = wanted(path)
        if licence is None:
            print(f"{path}: no SPDX line: add {wanted(path)} (licences.py . "
                  "--add), or list it in REUSE.toml")
            bad = 1
            continue
        used.add(licence)
        if licence != wanted(path):
            print(f"{path}: {licence}, but {wanted(path)} is the licence of "
                  "its folder")
            bad = 1
    for licence in used:
        if not os.path.exists(os.path.join(root, "LICENSES", licence + ".txt")):
            print(f"LICENSES/{licence}.txt is missing")
            bad = 1
    for pattern, _ in rows:
        if not any(covers(pattern, path) for path in files(root)):
            print(f"REUSE.toml: no file matches {pattern}")
            bad = 1
    return bad


sys.exit(main())
