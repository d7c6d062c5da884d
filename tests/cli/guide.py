#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Checks that the worked cases of docs/guide give the results on their pages.

guide.py SOURCE PROGRAM FOLDER [PAGE...]

All command blocks (```sh) of a page are run unchanged in a copy of the examples
in FOLDER; every command must end with status 0. After each block, the tables up
to the next block that have the columns "figure | in the report | expected |
within" are compared with the JSON report that the text above the table names.
The page must show the decks of its example unchanged. Exit status 77: a page
needs a feature that this build lacks.
"""
import json
import os
import re
import shutil
import subprocess
import sys

PAGES = ["wing_from_cad", "wing_body", "duct", "adaptation", "aerofoil"]
HEADER = "| figure | in the report | expected | within |"


class Wrong(Exception):
    """The page and the program do not agree."""


class Skipped(Exception):
    """This build lacks something that the page needs."""


def run(command, folder, environment):
    print("  $ " + command, flush=True)
    done = subprocess.run(["bash", "-euc", command], cwd=folder,
                          env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode == 0:
        return
    if "cannot read CAD" in done.stdout:
        raise Skipped(done.stdout.strip().splitlines()[-1])
    raise Wrong("exit status %d: %s\n%s" % (done.returncode, command,
                                            done.stdout[-4000:]))


def figure(report, path):
    value = report
    for key in path.split("."):
        if not isinstance(value, dict) or key not in value:
            raise Wrong("the report has no " + path)
        value = value[key]
    return value


def compare(row, report):
    cells = [cell.strip() for cell in row.strip().strip("|").split("|")]
    if len(cells) != 4:
        raise Wrong("not a row of four cells: " + row)
    name, path, expected, within = cells
    got = figure(report, path.strip("`"))
    if not within:
        good = str(got).lower() == expected
    else:
        number = float(expected.replace(",", ""))
        share = float(re.fullmatch(r"([0-9.]+) %", within).group(1)) / 100
        good = abs(got - number) <= share * abs(number)
    print("  %s: %s, the page says %s%s" % (
        name, got, expected, " within " + within if within else ""))
    if not good:
        raise Wrong("%s (%s): the report has %s, the page says %s" % (
            name, path, got, expected))


def check_page(page, folder, environment):
    """Returns the numbers of commands run and of figures compared."""
    lines = open(page, encoding="utf-8").read().splitlines()
    report_name, commands, figures, at = None, 0, 0, 0
    while at < len(lines):
        line = lines[at]
        at += 1
        if line == "```sh":
            while lines[at] != "```":
                run(lines[at], folder, environment)
                commands += 1
                at += 1
            at += 1
        elif line.startswith("```"):
            while lines[at] != "```":
                at += 1
            at += 1
        elif line == HEADER:
            if not report_name:
                raise Wrong("no report is named above the table of " + page)
            with open(os.path.join(folder, report_name)) as f:
                report = json.load(f)
            at += 1  # the rule below the header
            while at < len(lines) and lines[at].startswith("|"):
                compare(lines[at], report)
                figures += 1
                at += 1
            report_name = None
        else:
            named = re.search(r"`([^`]*\.report\.json)`", line)
            report_name = named.group(1) if named else report_name
    return commands, figures


def check_decks(page, folder):
    text = open(page, encoding="utf-8").read()
    for name in os.listdir(folder):
        if name.endswith(".deck"):
            with open(os.path.join(folder, name), encoding="utf-8") as f:
                shown = "".join("    " + line if line.strip() else line
                                for line in f)
            if "\n\n" + shown + "\n" not in text:
                raise Wrong("the page does not show %s unchanged" % name)


def main():
    source, program, folder = map(os.path.abspath, sys.argv[1:4])
    pages = sys.argv[4:] or [os.path.join(source, "docs/guide", name + ".md")
                             for name in PAGES]
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(os.path.join(folder, "path"))
    # Link only the program: the bin folder of the build contains other programs
    # too.
    os.symlink(program, os.path.join(folder, "path", "vanguard"))
    environment = dict(os.environ, LC_ALL="C", COLUMNS="80")
    environment.pop("VANGUARD_HELPERS", None)
    environment["PATH"] = os.path.join(folder, "path") + ":" + os.environ["PATH"]
    failed = skipped = 0
    for page in pages:
        name = os.path.splitext(os.path.basename(page))[0]
        work = os.path.join(folder, name)
        example = os.path.join(source, "examples", name)
        os.makedirs(work)
        print(name, flush=True)
        try:
            if os.path.isdir(example):
                shutil.copytree(example, os.path.join(work, "examples", name))
                check_decks(page, example)
            commands, figures = check_page(page, work, environment)
            if commands < 4 or figures < 5:
                raise Wrong("only %d commands and %d figures" % (commands,
                                                                 figures))
        except Skipped as why:
            print("  skipped: %s" % why)
            skipped += 1
        except Wrong as why:
            print("FAILED: %s" % why)
            failed += 1
        shutil.rmtree(os.path.join(work, "build"), ignore_errors=True)
    return 1 if failed else 77 if skipped else 0


sys.exit(main())
