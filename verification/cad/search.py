#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Random CAD files with the default command.

usage: verification/cad/search.py [--vanguard PROGRAM] [--shapes PROGRAM]
           [--seed N] [--first N] [--count N] [--cpu SECONDS] [--work DIR]
           [--keep] [--json FILE] [--quick]
  --vanguard  program (default build/release/bin/vanguard)
  --shapes    writer of the files (default build/release/bin/vg_random_cad)
  --seed      another set of shapes (default 1)
  --first     number of the first shape (default 0)
  --count     number of shapes (default 2000)
  --cpu       limit of each run, seconds of processor time (default 60)
  --work      folder for the files (default: a temporary one)
  --keep      keep the files of all shapes, not only those of the faults
  --json      write one JSON object per shape to FILE
  --quick     16 shapes

Each file is given to `vanguard check -p FILE --y-plus 30 --reynolds 5e6
--reference-length L`, L being its longest side. The result must be the domain
of the shape, its volume within 0.2 %, the area of each face within 1 % and
no face less; or a refusal; within the time. A file that can
be read in two ways must be refused, and then be right with the option that the
message names for its domain. Open CASCADE's integrals give the
volume and the areas (shapes.cpp). Exit status 1 after a wrong domain, volume or
area, a lost face, a run without end, or a run that ended in another way than by
a message. Refusals are counted but are no failures."""
import argparse
import collections
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(
    os.path.abspath(__file__))))
VOLUME, AREA = 0.002, 0.01   # relative
BATCH = 20                   # shapes that are written at a time


def run(command, cpu):
    """Run a command; return its status, output, messages and time."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu + 5))
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as messages:
        child = subprocess.Popen(command, stdout=out, stderr=messages,
                                 preexec_fn=limit)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        messages.seek(0)
        return (child.returncode, out.read().decode("utf-8", "replace"),
                messages.read().decode("utf-8", "replace"),
                usage.ru_utime + usage.ru_stime)


def domain_of(flow):
    return "half" if flow["half"] != "no" else flow["kind"]


def faults_of(shape, report):
    """What is wrong with the surface of a report."""
    given = [p for p in report["remesh"]["patches"] if max(p["area"]) > 0]
    areas = sorted(p["area"][1] for p in given)
    total = sum(areas)
    volume = abs(report["remesh"]["volume"] or
                 sum(s["volume"] for s in report["surface"]["shells"]))
    faults = []
    if domain_of(report["flow"]) != shape["domain"]:
        faults.append("wrong domain: %s" % domain_of(report["flow"]))
    if shape["domain"] != "half" and \
            abs(volume / shape["volume"] - 1) > VOLUME:
        faults.append("volume %.6g, not %.6g" % (volume, shape["volume"]))
    if abs(total / shape["area"] - 1) > AREA:
        faults.append("area %.6g, not %.6g" % (total, shape["area"]))
    if shape["faces"] and len(areas) < len(shape["faces"]):
        faults.append("%d faces, not %d" % (len(areas), len(shape["faces"])))
    if len(areas) == len(shape["faces"]):
        worst = max(abs(a / b - 1)
                    for a, b in zip(areas, sorted(shape["faces"])))
        if worst > AREA:
            faults.append("area of a face changed by %.3g %%" % (100 * worst))
    worst = max((abs(new / old - 1) for old, new in
                 (p["area"] for p in given) if old > 0), default=0)
    if worst > AREA:
        faults.append("area of a patch changed by %.3g %%" % (100 * worst))
    return faults


def last_message(text):
    lines = [l for l in text.splitlines() if l.startswith("vanguard: ")]
    return (lines or text.splitlines() or ["no message"])[-1]


def judge(shape, path, asked):
    command = [asked.vanguard, "check", "-j", "-q", "-p", path, "--y-plus",
               "30", "--reynolds", "5e6", "--threads", "1",
               "--reference-length", "%g" % shape["length"],
               *shape["options"].split()]
    status, out, messages, cpu = run(command, asked.cpu)
    answer = "--flow " + shape["domain"]
    if status == 1 and "two ways" in messages and answer in messages:
        shape["options"] = (shape["options"] + " " + answer).strip()
        status, out, messages, cpu = run(command + answer.split(), asked.cpu)
    result = {**shape, "cpu": round(cpu, 2), "status": status, "faults": [],
              "message": ""}
    if status == -signal.SIGXCPU or cpu >= asked.cpu:
        result["faults"] = ["no end in %d s" % asked.cpu]
    elif status == 0:
        result["faults"] = faults_of(shape, json.loads(out))
    elif status == 1:
        result["message"] = last_message(messages)
    else:
        result["faults"] = ["status %d" % status]
        result["message"] = last_message(messages)
    return result


def report_of(result):
    words = ("WRONG: " + "; ".join(result["faults"]) if result["faults"]
             else "refused: " + result["message"] if result["status"]
             else "right")
    return "%-28s %6.1f s  %s" % (result["file"], result["cpu"], words)


def search(asked, work, log):
    count = collections.Counter()
    for first in range(asked.first, asked.first + asked.count, BATCH):
        n = min(BATCH, asked.first + asked.count - first)
        folder = os.path.join(work, "%05d" % first)
        os.makedirs(folder, exist_ok=True)
        run([asked.shapes, folder, str(asked.seed), str(first), str(n)], 300)
        with open(os.path.join(folder, "shapes.jsonl"),
                  encoding="utf-8") as lines:
            shapes = [json.loads(line) for line in lines]
        for shape in shapes:
            path = os.path.join(folder, shape["file"])
            result = judge(shape, path, asked)
            count["wrong" if result["faults"] else
                  "refused" if result["status"] else "right"] += 1
            if result["faults"] or result["status"]:
                print(report_of(result), flush=True)
            elif not asked.keep:
                os.remove(path)
            if log:
                del result["faces"]
                log.write(json.dumps(result) + "\n")
                log.flush()
    print("%d shapes: %d right, %d refused, %d wrong" % (
        sum(count.values()), count["right"], count["refused"], count["wrong"]))
    return 1 if count["wrong"] else 0


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    build = os.path.join(ROOT, "build", "release", "bin")
    parser.add_argument("--vanguard", default=os.path.join(build, "vanguard"))
    parser.add_argument("--shapes",
                        default=os.path.join(build, "vg_random_cad"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--cpu", type=int, default=60)
    parser.add_argument("--work")
    parser.add_argument("--json")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--quick", action="store_true")
    asked = parser.parse_args()
    if asked.quick:
        asked.count = 16
    for program in asked.vanguard, asked.shapes:
        if not os.path.exists(program):
            print("SKIP: no program " + program)
            return 77
    work = asked.work or tempfile.mkdtemp()
    try:
        with open(asked.json or os.devnull, "w", encoding="utf-8") as log:
            return search(asked, work, log)
    finally:
        if not asked.work:
            shutil.rmtree(work)


if __name__ == "__main__":
    sys.exit(main())
