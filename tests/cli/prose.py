#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Finds phrases that make comments, documents and messages hard to read.

Prints file:line, the phrase and a remedy for each. The list is a filter for the
most frequent habits, not a definition of good prose: rewrite the whole sentence
rather than replacing the word (CONTRIBUTING.md, "Language").

It reads comments and messages of code, comments of scripts, and documents
without their code blocks and code spans. EXCEPTIONS has the accepted phrases.
Pages of docs/guide and docs/reference must not carry dates either: measurements
belong to docs/lab.

prose.py ROOT [PATH...]   PATH: files or folders below ROOT; default: all files
Exit status: 0 nothing found, 1 something found.
"""
import os
import re
import subprocess
import sys

PHRASES = [(re.compile(pattern, re.I), remedy) for pattern, remedy in (
    # words that native speakers use differently
    (r"\banew\b", '"again", "remeshed", "recomputed"'),
    (r"\bbeside\b", '"next to", "adjacent to", "in addition to"'),
    (r"\bas ever\b|\blikewise\b", '"as before", "in the same way"'),
    (r"\bat hand\b", '"available", "in memory"'),
    (r"\bin common\b", '"shared"'),
    (r"\bby chance\b|\bof chance\b", '"random", "accidentally"'),
    (r"\bhang(s|ing)? (together|apart)\b", '"connected", "not connected"'),
    (r"\b(comes?|came) of\b", '"results from"'),
    (r"\bf(all|alls|ell) into\b", '"is split into"'),
    (r"\b(lies|lie|lay) off\b", '"is away from", "is outside"'),
    (r"\bgiven up\b|\bgives? up\b", '"abandoned", "fails"'),
    (r"\bput(s|ting)? in\b(?!to)|\b(take|takes|taken) away\b",
     '"insert", "remove"'),
    (r"\blook(s|ed)? at\b", '"visit", "examine"'),
    (r"\bon (its|their|the) way\b", "name the state or the stage"),
    (r"\b(what for|wherefore|whereof|thereof)\b", "plain words"),
    # verb forms
    (r"\b(is|are|was|were) to be\b", '"must be", "will be"'),
    (r"\b(is|are|be|was|were) told\b(?! to)",
     '"is reported", "is determined"'),
    # clauses without a noun
    (r"(^|[.;:] |\*\*? )(?-i:What) (is|was|are|has|had|lies|does|did|goes|came"
     r"|they|it|one|this|that|the|of)\b(?!.*\?)",
     'name the thing: "The cells that ..."'),
    (r"\b(of|by|for|in|with|than|and|at|from|to) what (is|was|are|has|had|lies"
     r"|they|it|the|this|one|of|made|makes)\b", "name the thing"),
    (r"\b(those that are not|the rest is|the one that)\b", "name the thing"),
    (r"\b(others|another|other [a-z]+s|theirs|ours|hers)' ?[.;,)]|another's\b",
     "complete the phrase"),
    # quantities
    (r"(?<!there )\b(is|are|was|were|be) none\b|\bnone any ?more\b|\bno more of\b",
     '"no longer ...", "is not a ..."'),
    (r"\b(so|as) (many|much)\b(?! (that|as|more|less)\b)",
     '"that many", "up to n"'),
    (r"\bby as much\b|\bas much as that\b", "give the quantity"),
    (r"\bno matter[.;,)]", '"ignored", "any"'),
)]

# file, phrase, reason; at most 40
EXCEPTIONS = (
    ("src/run/settings/settings_check.c", "is none", "none is a value"),
    ("tests/cli/prose.py", None, "the list itself"),
    ("CONTRIBUTING.md", None, "quotes bad examples next to good ones"),
)
MOST = 40

DATE = re.compile(r"\b(19|20)\d\d-(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])\b")
UNDATED = ("docs/guide/", "docs/reference/")
CODE = (".c", ".h", ".cpp", ".js", ".in")
SCRIPTS = (".py", ".sh", ".cmake", "CMakeLists.txt")
DOCUMENTS = (".md",)
FOLDERS = ("src", "helpers", "tests", "bench", "cmake", "docs", "python", "examples",
           "share", "verification")


def tracked(root, paths):
    """Names of the files below root that git tracks, or, without git, of all
    files in its folders."""
    try:
        out = subprocess.run(["git", "-C", root, "ls-files", "-z", *paths],
                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                             check=True).stdout
        return [name for name in out.decode().split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        found = [f for f in os.listdir(root)
                 if os.path.isfile(os.path.join(root, f))]
        for folder in FOLDERS:
            for at, unused, names in os.walk(os.path.join(root, folder)):
                found += [os.path.relpath(os.path.join(at, name), root)
                          for name in names]
        return [f for f in sorted(found)
                if not paths or f.startswith(tuple(paths))]


def document(lines):
    """Lines without code spans; code blocks are left out."""
    block = before_blank = False
    for n, line in enumerate(lines, 1):
        blank = not line.strip()
        block = (block or before_blank) and (blank or line.startswith("    "))
        if not block:
            yield n, re.sub(r"`[^`]*`", "", line)
        before_blank = blank


def script(lines):
    """Comments of a script."""
    for n, line in enumerate(lines, 1):
        m = re.search(r"(?:^|\s)#(?!!)(.*)", line)
        if m:
            yield n, m[1]


def code(lines):
    """Comments, and string literals that have several words."""
    inside = False
    for n, line in enumerate(lines, 1):
        start = 0 if inside else line.find("/*")
        if start >= 0:
            yield n, line[start:]
            inside = "*/" not in line[start:]
            continue
        for text in re.findall(r'"((?:[^"\\]|\\.)*)"', line):
            if " " in text.strip():
                yield n, text


def prose(name, lines):
    """(line number, text) of the parts of a file that people read."""
    if name.endswith(DOCUMENTS):
        return document(lines)
    if name.endswith(SCRIPTS):
        return script(lines)
    return code(lines)


def main(root, paths):
    if len(EXCEPTIONS) > MOST:
        sys.exit(f"{len(EXCEPTIONS)} exceptions, {MOST} are allowed")
    n_found = n_lines = 0
    for name in tracked(root, paths):
        if not name.endswith(CODE + SCRIPTS + DOCUMENTS):
            continue
        allowed = {phrase for file, phrase, unused in EXCEPTIONS
                   if file == name}
        try:
            with open(os.path.join(root, name), errors="replace") as f:
                lines = f.read().splitlines()
        except OSError:   # removed, but not yet committed
            continue
        found = []
        for n, text in prose(name, lines):
            n_lines += 1
            for pattern, remedy in PHRASES:
                m = pattern.search(text)
                if m and not allowed & {None, m[0].strip().lower()}:
                    found.append((n, m[0].strip(), remedy))
        if name.startswith(UNDATED):
            found += [(n, DATE.search(line)[0], "dates belong to docs/lab")
                      for n, line in enumerate(lines, 1) if DATE.search(line)]
        for n, phrase, remedy in sorted(found):
            print(f'{name}:{n}: "{phrase}": {remedy}')
        n_found += len(found)
    print(f"{n_found} phrases in {n_lines} lines of prose")
    return n_found > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
