#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cases of Vanguard: makes them, runs them here or on Slurm or PBS, and collects
their reports in a table. Needs the standard library only.

    import vanguard_cases as vc

    cases = [vc.Case(f"runs/g{g}", "wing.stl", {"settings": {"growth": g}})
             for g in (1.15, 1.2, 1.3)]
    for case in cases:
        case.make()
    vc.submit(cases, vc.Slurm(ranks=8, threads=4, time="02:00:00"))
    rows = vc.collect(cases)

A case is a folder: a copy of the surface with its companions, the deck as JSON
(vanguard deck --schema describes it), the script run.sh, the results in out, the
log in run.log and the run directory run.store, from which a run that was stopped
is resumed. docs/reference/programs.md has more.

As a program: vanguard-cases make|submit|collect|state --help
"""
import argparse
import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time

# Files in the folder of a surface that belong to its project.
COMPANIONS = (".mapbc", ".tags", ".bc", ".d3m", ".front")
HERE = os.path.dirname(os.path.realpath(__file__))   # bin has links


class CaseError(Exception):
    """A case that cannot be made or submitted; the message says why."""


def _program():
    """The program: VANGUARD, the one installed with this file, or by PATH."""
    installed = os.path.join(HERE, "..", "..", "..", "bin", "vanguard")
    found = os.environ.get("VANGUARD") or (
        os.path.normpath(installed) if os.path.exists(installed)
        else shutil.which("vanguard"))
    if not found:
        raise CaseError("the program vanguard was not found; set VANGUARD")
    return os.path.abspath(found)


def _batch_script():
    """share/slurm/vanguard.sbatch, in the installation or the source tree."""
    for path in ("../vanguard.sbatch", "../slurm/vanguard.sbatch"):
        path = os.path.normpath(os.path.join(HERE, path))
        if os.path.exists(path):
            return path
    raise CaseError("vanguard.sbatch is not installed with this module")


# --- queues ------------------------------------------------------------------

class Local:
    """Runs cases here, one after the other. threads 0: all cores."""

    name = "local"

    def __init__(self, ranks=1, threads=0):
        self.ranks, self.threads = ranks, threads

    def directives(self, name):
        return []

    def submit(self, script):
        """Returns when the run has ended."""
        with open("run.log", "a") as log:
            subprocess.run(["bash", script], stdout=log,
                           stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        return None

    def state(self, job):
        return None


class Slurm:
    """Submits with sbatch. `options` are further lines for #SBATCH, such as
    "--partition=long". A run that reaches its time limit is resumed by itself."""

    name = "slurm"

    def __init__(self, ranks=1, threads=1, nodes=1, time="02:00:00",
                 options=()):
        self.ranks, self.threads, self.nodes = ranks, threads, nodes
        self.time, self.options = time, list(options)

    def directives(self, name):
        return ["#SBATCH " + line for line in [
            f"--job-name={name}", f"--nodes={self.nodes}",
            f"--ntasks={self.ranks}", f"--cpus-per-task={self.threads}",
            "--hint=nomultithread", f"--time={self.time}",
            "--signal=B:USR1@120", "--requeue", "--open-mode=append",
            "--output=run.log", *self.options]]

    def submit(self, script):
        return _answer(["sbatch", "--parsable", script]).split(";")[0]

    def state(self, job):
        ran = _run(["squeue", "-h", "-j", job, "-o", "%T"])
        word = ran.stdout.strip() if ran.returncode == 0 else ""
        return {"": None, "RUNNING": "running",
                "COMPLETING": "running"}.get(word, "queued")


class Pbs:
    """Submits with qsub (PBS Pro, OpenPBS). `options` are further lines for #PBS,
    such as "-q long"."""

    name = "pbs"

    def __init__(self, ranks=1, threads=1, nodes=1, time="02:00:00",
                 options=()):
        if ranks % nodes:
            raise CaseError(f"{ranks} ranks do not divide among {nodes} nodes")
        self.ranks, self.threads, self.nodes = ranks, threads, nodes
        self.time, self.options = time, list(options)

    def directives(self, name):
        per_node = self.ranks // self.nodes
        return ["#PBS " + line for line in [
            f"-N {name[:15]}",
            f"-l select={self.nodes}:ncpus={per_node * self.threads}"
            f":mpiprocs={per_node}:ompthreads={self.threads}",
            f"-l walltime={self.time}", "-j oe", "-o run.log", "-k oed",
            *self.options]]

    def submit(self, script):
        return _answer(["qsub", script])

    def state(self, job):
        ran = _run(["qstat", "-f", job])
        word = re.search(r"job_state = (\w)", ran.stdout)
        if ran.returncode or not word or word[1] in "CFX":
            return None
        return "running" if word[1] in "RE" else "queued"


QUEUES = {kind.name: kind for kind in (Local, Slurm, Pbs)}


def _run(words):
    try:
        return subprocess.run(words, capture_output=True, text=True)
    except FileNotFoundError:
        raise CaseError(f"{words[0]} is not installed here") from None


def _answer(words):
    ran = _run(words)
    if ran.returncode or not ran.stdout.strip():
        raise CaseError(f"{shlex.join(words)}: {ran.stderr.strip()}")
    return ran.stdout.strip()


# --- cases -------------------------------------------------------------------

class Case:
    """A run of vanguard mesh in a folder of its own.

    surface: a surface file; deck: a JSON document as a dictionary. Without
    them, an existing case."""

    def __init__(self, folder, surface=None, deck=None):
        self.folder = os.path.abspath(folder)
        self.name = os.path.basename(self.folder)
        self._surface, self._deck = surface, deck or {}
        if surface is None:
            try:
                with open(self._path("case.json")) as f:
                    self.surface = json.load(f)["surface"]
            except (OSError, ValueError, KeyError):
                raise CaseError(f"{folder}: not a case (no case.json)") from None
        else:
            self.surface = os.path.basename(surface)
        self.stem = self._stem_of(self.surface)

    @staticmethod
    def _stem_of(name):
        stem = re.sub(r"\.gz$", "", name)
        return re.sub(r"(\.[a-z0-9]+\.ugrid(64)?|\.\w+)$", "", stem, flags=re.I)

    def _path(self, *names):
        return os.path.join(self.folder, *names)

    def make(self):
        """Make the folder and have the program check the deck. The folder must
        not exist."""
        if os.path.exists(self.folder):
            raise CaseError(f"{self.folder} exists; remove it, or choose "
                            "another folder")
        if not os.path.exists(self._surface):
            raise CaseError(f"{self._surface}: this file does not exist")
        fresh = self.folder + ".new"
        shutil.rmtree(fresh, ignore_errors=True)
        os.makedirs(fresh)
        try:
            self._fill(fresh)
            os.rename(fresh, self.folder)
        finally:
            shutil.rmtree(fresh, ignore_errors=True)
        return self

    def _fill(self, folder):
        shutil.copy(self._surface, folder)
        stem = os.path.join(os.path.dirname(self._surface), self.stem)
        for suffix in COMPANIONS:
            if os.path.exists(stem + suffix):
                shutil.copy(stem + suffix, folder)
        deck = os.path.join(folder, self.stem + ".deck")
        with open(deck, "w") as f:
            json.dump({"title": self.name, **self._deck}, f, indent=2)
        ran = _run([_program(), "deck", "--deck", deck, "--json"])
        if ran.returncode:
            raise CaseError(ran.stderr.strip().replace(folder, self.folder))
        with open(os.path.join(folder, "case.json"), "w") as f:
            json.dump({"surface": self.surface}, f)

    def submit(self, queue):
        """Write run.sh and submit it, unless the case is done or in the queue.
        A run that was stopped is resumed. Returns the state."""
        before = self.state()
        if before in ("done", "limit", "queued", "running"):
            return before
        with open(self._path("run.sh"), "w") as f:
            f.write("\n".join(["#!/bin/bash", *queue.directives(self.name),
                               *self._commands(queue)]) + "\n")
        here = os.getcwd()
        os.chdir(self.folder)
        try:
            self._keep_job(queue.name, None)
            job = queue.submit("run.sh")
            if job:
                self._keep_job(queue.name, job)
        finally:
            os.chdir(here)
        return self.state()

    def _commands(self, queue):
        threads = queue.threads or os.cpu_count()
        values = {"PROJECT": self.surface, "OUT": "out", "RUN_DIR": "run.store",
                  "OPTIONS": "--quiet", "VANGUARD": _program(),
                  "NTASKS": queue.ranks, "CPUS": threads}
        return [f"cd {shlex.quote(self.folder)} || exit 1",
                "echo '--- run'",
                *(f"export {k}={shlex.quote(str(v))}" for k, v in
                  values.items()),
                f"exec bash {shlex.quote(_batch_script())}"]

    def _keep_job(self, queue, job):
        with open(self._path("job.json"), "w") as f:
            json.dump({"queue": queue, "id": job}, f)

    def _log(self):
        """The part of run.log that belongs to the last run."""
        try:
            with open(self._path("run.log"), errors="replace") as f:
                return f.read().rpartition("--- run\n")[2]
        except OSError:
            return ""

    def status(self):
        """Exit status of the last run; None: it has not ended by itself."""
        found = re.findall(r" exit status (\d+)$", self._log(), re.M)
        return int(found[-1]) if found else None

    def state(self):
        """made, queued, running, stopped (submit resumes it), done, limit (done,
        but a limit on the layers is not met) or failed."""
        try:
            with open(self._path("job.json")) as f:
                job = json.load(f)
        except (OSError, ValueError):
            return "made"
        if job["id"]:
            now = QUEUES[job["queue"]]().state(job["id"])
            if now:
                return now
        status = self.status()
        if status == 0:
            return "done"
        if status == 4:
            return "limit"
        was_stopped = "; the same command resumes from" in self._log()
        was_killed = status is None and os.path.exists(
            self._path("run.store", "run.txt"))
        return "stopped" if was_stopped or was_killed else "failed"

    def report(self):
        """The report of the run as a dictionary; None: there is none."""
        try:
            with open(self._path("out", self.stem + ".report.json")) as f:
                return json.load(f)
        except OSError:
            return None

    def files(self):
        """Paths of the results."""
        report = self.report() or {}
        return [os.path.normpath(self._path(f["path"]))
                for f in report.get("files", ())]

    def row(self):
        """The main figures as a flat dictionary."""
        row = {"case": self.name, "state": self.state(),
               "status": self.status()}
        report = self.report()
        if row["state"] == "failed":
            lines = re.findall(r"^vanguard: (.*)", self._log(), re.M)
            row["error"] = lines[-1] if lines else "see run.log"
        if not report or row["state"] not in ("done", "limit"):
            return row
        mesh, layers = report["mesh"], report.get("layers") or {}
        field = report.get("field") or mesh
        row.update({
            "points": mesh["points"], "cells": mesh["cells"],
            "valid": mesh["valid"], "angle_min": field["angle_min"],
            "angle_max": field["angle_max"],
            "prisms": layers.get("prisms", 0),
            "percent_full": layers.get("all", {}).get("percent_full"),
            "first_height": layers.get("all", {}).get("first", {}).get("mean"),
            "seconds": report["seconds"]["total"],
            "peak_memory_bytes": report["peak_memory_bytes"]})
        return row


def submit(cases, queue):
    """Submit all cases; returns their states."""
    return [case.submit(queue) for case in cases]


def wait(cases, seconds=30, limit=None):
    """Wait until no case is queued or running, or for `limit` seconds. Returns
    the states."""
    end = None if limit is None else time.monotonic() + limit
    while True:
        states = [case.state() for case in cases]
        if not {"queued", "running"} & set(states):
            return states
        if end is not None and time.monotonic() + seconds > end:
            return states
        time.sleep(seconds)


def collect(cases, path=None):
    """A row per case; path: also write them as CSV."""
    rows = [case.row() for case in cases]
    if path:
        names = list(dict.fromkeys(name for row in rows for name in row))
        with open(path, "w", newline="") as f:
            table = csv.DictWriter(f, names)
            table.writeheader()
            table.writerows(rows)
    return rows


# --- command line ------------------------------------------------------------

def _value(text):
    """A value of a setting on the command line, as JSON has it."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def _parse(words):
    top = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    sub = top.add_subparsers(dest="command", required=True)
    make = sub.add_parser("make", help="make a case")
    make.add_argument("folder")
    make.add_argument("surface")
    make.add_argument("--deck", help="a deck, text or JSON")
    make.add_argument("--set", action="append", default=[],
                      metavar="NAME=VALUE", help="a setting")
    run = sub.add_parser("submit", help="run or resume cases")
    run.add_argument("--queue", choices=sorted(QUEUES), default="local")
    run.add_argument("--ranks", type=int, default=1)
    run.add_argument("--threads", type=int, default=1)
    run.add_argument("--nodes", type=int, default=1)
    run.add_argument("--time", default="02:00:00")
    run.add_argument("--option", action="append", default=[],
                     help="a further option of the queue")
    run.add_argument("folder", nargs="+")
    table = sub.add_parser("collect", help="print a table of the results")
    table.add_argument("--csv", help="file to write")
    table.add_argument("folder", nargs="+")
    state = sub.add_parser("state", help="print the states of cases")
    state.add_argument("folder", nargs="+")
    return top.parse_args(words)


def _make(a):
    deck = {}
    if a.deck:
        ran = _run([_program(), "deck", "--deck", a.deck, "--json"])
        if ran.returncode:
            raise CaseError(ran.stderr.strip())
        deck = json.loads(ran.stdout)
    for pair in a.set:
        name, is_pair, text = pair.partition("=")
        if not is_pair:
            raise CaseError(f"--set {pair}: expected NAME=VALUE")
        deck.setdefault("settings", {})[name] = _value(text)
    Case(a.folder, a.surface, deck).make()


def main(words=None):
    a = _parse(words)
    try:
        if a.command == "make":
            _make(a)
            return 0
        cases = [Case(folder) for folder in a.folder]
        if a.command == "submit":
            queue = (Local(a.ranks, a.threads) if a.queue == "local" else
                     QUEUES[a.queue](a.ranks, a.threads, a.nodes, a.time,
                                     a.option))
            submit(cases, queue)
        if a.command == "collect":
            rows = collect(cases, a.csv)
        else:
            rows = [{"case": c.name, "state": c.state()} for c in cases]
        for row in rows:
            print("  ".join(f"{k}={v}" for k, v in row.items()))
        return 1 if any(row["state"] == "failed" for row in rows) else 0
    except CaseError as error:
        print(f"vanguard-cases: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
