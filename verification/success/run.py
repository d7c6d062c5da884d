#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Success rate of the default command on public geometry.

usage: verification/success/run.py --data DIR [--vanguard PROGRAM]
           [--meshcheck PROGRAM] [--work DIR] [--table FILE] [--json FILE]
           [--cpu SECONDS] [--jobs N] [NAME...]
  --data       folder of real geometry (verification/fetch.md)
  --vanguard   program (default build/release/bin/vanguard)
  --meshcheck  independent checker of a .ugrid (default: none)
  --work       folder for all results (default: a temporary one)
  --table      write the Markdown table to FILE as well
  --json       write one JSON object per file to FILE as well
  --cpu        limit of each run, seconds of processor time (default 300)
  --jobs       files that are processed at the same time (default 1)
  NAME         names in files.tsv (default: all)

Each file of files.tsv is given to `vanguard mesh -p FILE --y-plus 30
--reynolds 5e6 --reference-length L --write lb8.ugrid`, L being the longest side
of the bounding box of the body. If the run is refused, the options that its
message names are tried, one remedy at a time. The table has the verdict of each
file. Exit status 1 if a file gives a mesh of a wrong domain, a mesh that is not valid, or a patch that
changes its area by more than 1 %. Refusals are counted but are no failures."""
import argparse
import concurrent.futures
import gzip
import json
import lzma
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
REMEDY = re.compile(r"--close-holes yes --flow (?:internal|external)"
                    r"|--close-holes yes|--half [xyz]|--flow (?:internal|external)"
                    r"|--wrap [0-9.e+-]*[0-9]|--cad-solids only")
AREA_CHANGE = 1.0   # %, largest change of a patch's area


def read_list():
    """Rows of files.tsv: name, file, expected result, length, further options."""
    rows = []
    with open(os.path.join(HERE, "files.tsv"), encoding="utf-8") as lines:
        for line in lines:
            if line.startswith("#") or not line.strip():
                continue
            name, path, expected, length, *options = line.rstrip("\n").split("\t")
            rows.append({"name": name, "path": path, "expected": expected,
                         "length": float(length),
                         "options": options[0].split() if options else []})
    return rows


def unpack(source, folder):
    """Copy a file to the folder without its compression; return its path."""
    stem, suffix = os.path.splitext(os.path.basename(source))
    opener = {".xz": lzma.open, ".gz": gzip.open}.get(suffix)
    target = os.path.join(folder, stem if opener else stem + suffix)
    with (opener or open)(source, "rb") as given, open(target, "wb") as copy:
        shutil.copyfileobj(given, copy)
    return target


def run(command, cpu):
    """Run a command; return its status, output, processor time and memory."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu + 5))
    with tempfile.TemporaryFile() as output:
        child = subprocess.Popen(command, stdout=output,
                                 stderr=subprocess.STDOUT, preexec_fn=limit,
                                 start_new_session=True)
        end = time.monotonic() + 3 * cpu
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > end:
                os.killpg(child.pid, signal.SIGKILL)
            time.sleep(0.02)
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read().decode("utf-8", "replace")
    return {"status": child.returncode, "text": text,
            "cpu": usage.ru_utime + usage.ru_stime,
            "memory": usage.ru_maxrss / 1024}


def message_of(text):
    """Last message of the program, without the folder of the file."""
    text = re.sub(r"/\S*/(?=[^/\s]+)", "", text)
    lines = [line for line in text.splitlines() if line.startswith("vanguard: ")]
    return (lines[-1][len("vanguard: "):] if lines
            else " ".join(text[-200:].split()))


def domain_of(flow):
    """Domain of a report: external, internal or half."""
    if flow["half"] != "no":
        return "half"
    return flow["kind"]


def judge(report, row, mesh, meshcheck):
    """Figures of a mesh, and what is wrong with it."""
    areas = [abs(new / old - 1) * 100
             for old, new in (p["area"] for p in report["remesh"]["patches"])
             if old > 0] if report.get("remesh") else []
    layers = (report.get("layers") or {}).get("all") or {}
    figures = {"domain": domain_of(report["flow"]),
               "cells": report["mesh"]["cells"],
               "full": layers.get("percent_full"),
               "angle": report["field"]["angle_min"] if report.get("field")
               else report["mesh"]["angle_min"],
               "area_change": max(areas, default=0.0),
               "surface_seconds": report["seconds"]["read"] +
               report["seconds"]["check"]}
    wrong = []
    if figures["domain"] not in row["expected"].split("|"):
        wrong.append("wrong domain: " + figures["domain"])
    if not report["mesh"]["valid"]:
        wrong.append("not valid")
    if meshcheck and subprocess.run([meshcheck, "-q", mesh],
                                    stdout=subprocess.DEVNULL).returncode:
        wrong.append("not valid by the independent checker")
    if figures["area_change"] > AREA_CHANGE and "--wrap" not in row["options"]:
        wrong.append("area of a patch changed by %.3g %%" %
                     figures["area_change"])
    return figures, wrong


def attempt(row, path, remedy, folder, asked):
    out = os.path.join(folder, "out")
    shutil.rmtree(out, ignore_errors=True)
    command = [asked.vanguard, "mesh", "-p", path, "--y-plus", "30",
               "--reynolds", "5e6", "--reference-length", "%g" % row["length"],
               "--write", "lb8.ugrid", "--out", out, "--quiet",
               *(o.replace("{data}", asked.data) for o in row["options"]),
               *remedy]
    result = run(command, asked.cpu)
    result["remedy"] = " ".join(remedy)
    if result["status"] == 0:
        name, = (n for n in os.listdir(out) if n.endswith(".report.json"))
        stem = os.path.join(out, name[:-len(".report.json")])
        with open(stem + ".report.json", encoding="utf-8") as report:
            result.update(zip(("figures", "wrong"),
                              judge(json.load(report),
                                    {**row, "options": row["options"] + remedy},
                                    stem + ".lb8.ugrid", asked.meshcheck)))
    shutil.rmtree(out, ignore_errors=True)
    return result


def process(row, asked, folder):
    """Give one file to the program, then the remedies of its message."""
    os.makedirs(folder)
    path = unpack(os.path.join(asked.data, row["path"]), folder)
    tried = [attempt(row, path, [], folder, asked)]
    if tried[0]["status"] == 1:
        for words in dict.fromkeys(REMEDY.findall(message_of(tried[0]["text"]))):
            tried.append(attempt(row, path, words.split(), folder, asked))
            if tried[-1]["status"] == 0:
                break
    return {"name": row["name"], "expected": row["expected"],
            "tried": tried, "verdict": verdict(row, tried)}


def verdict(row, tried):
    last = tried[-1]
    if last["status"] == 0:
        if last["wrong"]:
            return "WRONG: " + "; ".join(last["wrong"])
        return "default" if len(tried) == 1 else "remedy"
    first = tried[0]
    if first["status"] != 1:
        return "no end" if first["status"] < 0 else "status %d" % first["status"]
    if row["expected"].startswith("refused"):
        words = row["expected"].partition(":")[2]
        return ("refused as expected" if words in first["text"]
                else "refused with other words")
    return "remedies fail" if len(tried) > 1 else "refused"


def line_of(result):
    """Row of the Markdown table."""
    last = result["tried"][-1]
    figures = last.get("figures") or {}

    def shown(key, form):
        value = figures.get(key)
        return "-" if value is None else form % value
    message = "" if last["status"] == 0 else \
        message_of(result["tried"][0]["text"])[:160].replace("|", "/")
    return "| %s | %s | %s | %s | %s | %s | %s | %s | %.1f | %.0f | %s | %s |" % (
        result["name"], result["expected"].partition(":")[0].replace("|", " or "),
        shown("domain", "%s"), last["remedy"], shown("cells", "%d"),
        shown("full", "%.1f"), shown("angle", "%.2f"),
        shown("area_change", "%.2f"), last["cpu"], last["memory"],
        result["verdict"], message)


HEAD = ("| file | domain | result | remedy | cells | full layers, % | "
        "worst angle | area change, % | processor time, s | memory, MB | "
        "verdict | message |\n|" + "---|" * 12)


def summary(results):
    bodies = [r for r in results if not r["expected"].startswith("refused")]
    count = {}
    for result in bodies:
        key = result["verdict"].partition(":")[0]
        count[key] = count.get(key, 0) + 1
    by_default, by_remedy = count.get("default", 0), count.get("remedy", 0)
    n = max(len(bodies), 1)
    return ("%d files that bound a body or a domain: %d (%.0f %%) by the "
            "default command, %d (%.0f %%) by it or with one option that the "
            "message names, "
            "%d wrong; %d of %d others refused as expected" % (
                len(bodies), by_default, 100 * by_default / n,
                by_default + by_remedy, 100 * (by_default + by_remedy) / n,
                count.get("WRONG", 0),
                sum(r["verdict"] == "refused as expected" for r in results),
                len(results) - len(bodies)))


def main():
    parser = argparse.ArgumentParser(usage=__doc__.replace("%", "%%"))
    parser.add_argument("--data", required=True)
    parser.add_argument("--vanguard", default=os.path.join(
        ROOT, "build/release/bin/vanguard"))
    parser.add_argument("--meshcheck")
    parser.add_argument("--work")
    parser.add_argument("--table")
    parser.add_argument("--json")
    parser.add_argument("--cpu", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("names", nargs="*")
    asked = parser.parse_args()
    rows = [r for r in read_list() if not asked.names or r["name"] in asked.names]
    missing = [r["path"] for r in rows
               if not os.path.exists(os.path.join(asked.data, r["path"]))]
    if missing:
        sys.exit("missing in %s (verification/fetch.md): %s" %
                 (asked.data, ", ".join(missing)))
    work = asked.work or tempfile.mkdtemp(prefix="success-")
    print(HEAD, flush=True)
    results = []
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        for result in pool.map(
                lambda row: process(row, asked,
                                    os.path.join(work, row["name"])), rows):
            results.append(result)
            print(line_of(result), flush=True)
    lines = [HEAD, *map(line_of, results), "", summary(results)]
    print("\n" + lines[-1])
    if asked.table:
        with open(asked.table, "w", encoding="utf-8") as table:
            table.write("\n".join(lines) + "\n")
    if asked.json:
        with open(asked.json, "w", encoding="utf-8") as stream:
            for result in results:
                stream.write(json.dumps(result) + "\n")
    if not asked.work:
        shutil.rmtree(work)
    sys.exit(any(r["verdict"].startswith("WRONG") for r in results))


if __name__ == "__main__":
    main()
