#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Branches of each source that the tests take; used by coverage.sh.

    gcov -b -c -j -t OBJECT... | branches.py SOURCE_FOLDER [--missed]

Reads one JSON document of gcov for each line of standard input. Prints "FILE
BRANCHES TAKEN" for each source, or with --missed "FILE LINE TEXT" for each
line with a branch that was not taken. Branches of exceptions, and those on
lines with assert() or VG_CHECK, do not count.
"""
import collections
import json
import os
import re
import sys

ASSERTION = re.compile(r"\b(assert|VG_CHECK\w*)\s*\(")


def assertion_lines(text):
    """Numbers of the lines of assertions, from their first to their last."""
    found = set()
    for match in ASSERTION.finditer(text):
        at, depth = match.end(), 1
        while at < len(text) and depth:
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        first = text.count("\n", 0, match.start()) + 1
        found.update(range(first, text.count("\n", 0, at) + 2))
    return found


def main():
    root = os.path.realpath(sys.argv[1]) + "/src/"
    counts = collections.defaultdict(dict)
    for line in sys.stdin:
        document = json.loads(line)
        folder = document["current_working_directory"]
        for source in document["files"]:
            path = os.path.realpath(os.path.join(folder, source["file"]))
            if not path.startswith(root) or not path.endswith((".c", ".cpp")):
                continue
            for row in source["lines"]:
                key = row["line_number"], row.get("function_name")
                taken = [b["count"] for b in row["branches"] if not b["throw"]]
                old = counts[path].get(key, [0] * len(taken))
                counts[path][key] = [a + b for a, b in zip(old, taken)]
    for path, rows in sorted(counts.items()):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        skipped = assertion_lines(text)
        rows = {k: v for k, v in rows.items() if v and k[0] not in skipped}
        name = path[len(root):]
        if "--missed" in sys.argv:
            lines = text.split("\n")
            for number in sorted({k[0] for k, v in rows.items() if 0 in v}):
                print(name, number, lines[number - 1].strip())
        else:
            print(name, sum(len(v) for v in rows.values()),
                  sum(1 for v in rows.values() for c in v if c))


main()
