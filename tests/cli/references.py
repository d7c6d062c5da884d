#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Resolves every reference to a document and reports those without a target:

  NAME.md                    a document in docs or in one of its folders
                             (FOLDERS_OF_DOCS, first match), in the root, or
                             in the folder of the file that cites it
  docs/reference/NAME.md     a document by its path from the root
  NAME.md 1.2                the heading with that number; also "1.2 and 1.3"
  NAME.md, "Title"           the heading of that title
  row K17, rows K17 to K19,  a row of a table of DECISIONS
  /* K17 ..., (K17)            the same in comments of the code
  [text](FILE#anchor)        in documents: the file and its heading
  core/mesh/mesh.h           a source file below src
  `mesh.h`                   in documents for contributors: the only source file
                             of that name, or that of a module which the same
                             line names

references.py ROOT
"""
import os
import re
import sys

CODE = (".c", ".h", ".cpp", ".sh", ".py", ".in", ".txt", ".cmake", ".js")
FOLDERS = ("src", "helpers", "tests", "bench", "cmake", "docs", "python", "examples",
           "share", "verification")
FOLDERS_OF_DOCS = ("docs", "docs/reference", "docs/guide", "docs/guide/solvers",
                   "docs/design", "docs/lab")
DECISIONS = "docs/design/decisions.md"
LIST = r"(?:,? (?:and|to) |, )"
NUMBER = r"\d+(?:\.\d+)*"
ROW = r"[A-Z]\d{1,2}"
CITED = re.compile(rf"(?:\$\w+/)?([\w./-]*\w\.md)\b`?((?: {NUMBER}(?:{LIST}{NUMBER})*)?)"
                   rf"(?:,? \"([A-Z][^\"]*)\")?")
ROWS = re.compile(rf"\b[Rr]ows? ({ROW}(?:{LIST}{ROW})*)")
TAGS = re.compile(rf"^/\*\s+({ROW}(?:{LIST}{ROW})*)(?=[:,.;]| \*/|$)")
IN_BRACKETS = re.compile(rf"\(({ROW}(?:{LIST}{ROW})*)\)")
LINK = re.compile(r"\]\(([^)\s#]*)(?:#([^)\s]+))?\)")
SOURCE = re.compile(r"(?<![\w/.-])(?:src/)?((?:base|core|layers|partition|io|"
                    r"run|api|cli)/[\w/]+\.(?:c|h|cpp))\b")
BARE = re.compile(r"`([a-z]\w*\.(?:c|h|cpp))`")
FOR_CONTRIBUTORS = ("docs/design/", "CONTRIBUTING.md", "tests/README.md")
FOLDERS_OF_CODE = ("src/", "helpers/", "tests/", "bench/", "examples/")
problems = []


def complain(path, what):
    problems.append(f"{path}: {what}")


def files(root):
    """Documents and code, as paths from the root."""
    found = [f for f in os.listdir(root) if f.endswith(".md")]
    for folder in FOLDERS:
        for at, below, names in os.walk(os.path.join(root, folder)):
            below.sort()
            found += [os.path.relpath(os.path.join(at, name), root)
                      for name in names if name.endswith(CODE + (".md",))]
    return sorted(found)


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as f:
        return f.read()


def running(text):
    """Text without line ends and without the markers that begin comment lines."""
    return re.sub(r"\s*\n[ \t]*(?:(?:\*|#|//)[ \t]+)?", " ", text)


class Document:
    """Headings of a document by number, title and anchor."""

    def __init__(self, text):
        titles = re.findall(r"^#+ (.*?)\s*$", text, re.M)
        self.numbers = {m[1] for t in titles
                        if (m := re.match(rf"({NUMBER}) ", t))}
        self.titles = {re.sub(rf"^{NUMBER} ", "", t).replace("`", "")
                       for t in titles}
        self.anchors = {re.sub(r"[^\w -]", "", t.lower()).replace(" ", "-")
                        for t in titles}


def check_cited(root, path, text, documents):
    for m in CITED.finditer(text):
        name, numbers, title = m[1], re.findall(NUMBER, m[2]), m[3]
        places = [os.path.join(os.path.dirname(path), name), name]
        if "/" not in name:
            places += [os.path.join(folder, name) for folder in FOLDERS_OF_DOCS]
        target = next((p for p in map(os.path.normpath, places)
                       if os.path.exists(os.path.join(root, p))), None)
        if not target:
            complain(path, f"{name} does not exist")
            continue
        if target not in documents:
            documents[target] = Document(read(root, target))
        for number in numbers:
            if number not in documents[target].numbers:
                complain(path, f"{target} has no section {number}")
        if title and title not in documents[target].titles:
            complain(path, f'{target} has no heading "{title}"')


def check_rows(path, text, rows):
    named = ROWS.findall(text)
    if path.endswith((".c", ".h", ".cpp")):
        for comment in re.findall(r"/\*.*?\*/", text):
            named += TAGS.findall(comment) + IN_BRACKETS.findall(comment)
    for row in (row for group in named for row in re.findall(ROW, group)):
        if row not in rows:
            complain(path, f"{DECISIONS} has no row {row}")


def check_links(root, path, text, documents):
    for target, anchor in LINK.findall(re.sub(r"`[^`]*`", "", text)):
        if re.match(r"\w+:", target):
            continue
        file = path
        if target:
            file = os.path.normpath(os.path.join(os.path.dirname(path), target))
        if not os.path.exists(os.path.join(root, file)):
            complain(path, f"the link to {target} leads nowhere")
        elif anchor and file in documents and \
                anchor not in documents[file].anchors:
            complain(path, f"{file} has no heading for #{anchor}")


def check_sources(root, path, text):
    if not path.startswith(("src/", "docs/", "tests/unit/", "CONTRIBUTING")):
        return
    for name in SOURCE.findall(text):
        if "NAME" not in name and \
                not os.path.exists(os.path.join(root, "src", name)):
            complain(path, f"src/{name} does not exist")


def check_bare_names(path, text, code):
    if not path.startswith(FOR_CONTRIBUTORS):
        return
    for line in text.splitlines():
        for name in BARE.findall(line):
            places = code.get(name, [])
            named = [p for p in places if p.replace("src/", "") in line]
            if not places:
                complain(path, f"there is no source file {name}")
            elif len(places) > 1 and len(named) != 1:
                complain(path, f"{name} is in " + ", ".join(places) +
                         ": name the folder")


def source_names(paths):
    """Folders of each file name of the code."""
    code = {}
    for path in paths:
        if path.startswith(FOLDERS_OF_CODE) and path.endswith(CODE):
            folder, name = os.path.split(path)
            code.setdefault(name, []).append(folder)
    return code


def main(root):
    texts = {path: read(root, path) for path in files(root)
             if "references" not in path and not path.endswith("_fails.sh")}
    documents = {path: Document(text) for path, text in texts.items()
                 if path.endswith(".md")}
    listed = re.findall(rf"^\| ({ROW}) \|",
                        texts.get(DECISIONS, ""), re.M)
    for row in sorted({row for row in listed if listed.count(row) > 1}):
        complain(DECISIONS, f"row {row} occurs twice")
    code = source_names(files(root))
    for path, text in texts.items():
        joined = running(text)
        check_cited(root, path, joined, documents)
        check_rows(path, joined, set(listed))
        check_sources(root, path, text)
        check_bare_names(path, text, code)
        if path in documents:
            check_links(root, path, text, documents)
    print("\n".join(problems) or
          f"{len(texts)} files: every reference has a target")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
