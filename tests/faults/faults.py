#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Injected faults: every call site of the C library fails once.

    faults.py --vanguard PROGRAM --library fault_calls.so [--depth N] [--case NAME]
              [--share K/N] [--of PATTERN] [--jobs N] [--site HASH] [FOLDER]

A first run of each case records the sites of its calls (fault_calls.c). One run
for each site that no earlier case has follows, in which its first call fails, and
one in which all later calls of the same class fail, too. The outcome must be one
of these two:

- status 0, and the files and the output of the undisturbed run;
- a failure with a message on standard error, and no files. A hidden folder can
  stay if the message explains how to go on; files stay if the message says that
  only standard output, or only the log, could not be written.

A run that ends by a signal, that is still running after two minutes, that says
nothing, or that leaves other files, is a fault.

--share K/N selects part K of N parts of the sites, by their hash. --of PATTERN
selects those with a frame in a source whose name begins so, and each fails once:
with the program of a build for coverage, these failures are counted. (Without
any memory, gcov itself fails.)
"""
import argparse
import concurrent.futures
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SECONDS = 120
CLEANING = ("open", "openat", "opendir", "fdopendir", "unlink", "unlinkat",
            "rmdir", "close", "read", "fsync")
NUMBER = re.compile(rb"[-+]?\d[\d,]*(\.\d+)?([eE][-+]?\d+)?")
ENVIRONMENT = {
    "LC_ALL": "C",
    "COLUMNS": "80",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}


def plain(text):
    """A report without its numbers and the width of their columns, and without
    what else depends on the moment: the stage with the greatest memory, and free
    memory that is not known."""
    text = re.sub(rb" +", b" ", NUMBER.sub(b"#", text))
    text = re.sub(rb"(?m)^.*# MB.*\n", b"", text)
    text = re.sub(rb'("stage": ")[a-z ,]+', rb"\1#", text)
    text = re.sub(rb'("[a-z_]*(memory|free|available)[a-z_]*": )null',
                  rb"\1#", text)
    return re.sub(rb"(?m)^ *note: .*\n", b"", text)


class Case:
    """One case: shell lines that prepare its folder, and the line that runs
    with faults. In it, `vg` is the program with the faults."""

    def __init__(self, name, words, prepare, line):
        self.name, self.prepare, self.line = name, prepare, line
        self.is_short = "short" in words
        self.status = 1 if "fails" in words else 0
        self.reference = None
        self.varying = set()


def read_cases(path):
    """Blocks separated by blank lines: `name [short] [fails]`, lines that
    prepare, and the line with faults, which starts with `!`."""
    cases = []
    for block in expanded(open(path).read().split("\n\n")):
        lines = [x for x in block.split("\n") if x and not x.startswith("#")]
        if not lines:
            continue
        words = lines[0].split()
        cases.append(
            Case(words[0], words[1:], "\n".join(lines[1:-1]),
                 lines[-1].lstrip("! ")))
    return cases


def expanded(blocks):
    """A first line with `for WORD...` makes one block for each word, with the
    word in the place of @."""
    for block in blocks:
        head, _, rest = block.partition("\n")
        name, _, words = head.partition(" for ")
        for word in words.split() or [None]:
            text = name + "\n" + rest
            yield text if word is None else text.replace("@", word)


class Outcome:
    def __init__(self, status, out, err, files, failed):
        self.status, self.out, self.err = status, out, err
        self.files, self.failed = files, failed


def content(path):
    """Digest of a file. Reports have times: numbers are removed from their
    text, and of pages and locks only the end is compared."""
    data = open(path, "rb").read()
    if re.search(r"\.(html|lock|svg)$", path):
        return b"text " + data[-8:].strip()[-1:]
    if re.search(r"\.(json|deck|log|txt|md|csv)$", path):
        return b"text " + plain(data)
    return hashlib.sha256(data).digest()


def tree(folder):
    found = {}
    for base, _, files in os.walk(folder):
        relative = os.path.relpath(base, folder)
        if relative != ".":
            found[relative + "/"] = b""
        for name in files:
            found[os.path.normpath(os.path.join(relative, name))] = content(
                os.path.join(base, name))
    return found


class Runner:
    def __init__(self, options, root):
        self.options, self.root = options, root
        self.program = os.path.realpath(options.vanguard)

    def folder(self, case):
        return os.path.join(self.root, case.name)

    def shell(self, folder, text, environment, is_plain):
        preload = self.options.library if not is_plain else ""
        head = f"""vg() {{ LD_PRELOAD='{preload}' '{self.program}' "$@"; }}
program='{self.program}'; preload='{preload}'
library_program='{self.options.library_program}'
build='{os.path.dirname(os.path.dirname(self.program))}'; here='{HERE}'
set -o pipefail
. "$here/shapes.sh"
"""
        job = subprocess.Popen(
            ["timeout", "-k", "2", str(SECONDS), "bash", "-c", head + text],
            cwd=folder, env={**os.environ, **ENVIRONMENT, **environment},
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE)
        out, err = job.communicate()
        return job.returncode, out, err

    def prepare(self, case):
        folder = os.path.join(self.folder(case), "in")
        os.makedirs(folder)
        status, out, err = self.shell(folder, "set -e\n" + case.prepare, {},
                                      True)
        if status == 77:
            return False
        if status:
            sys.exit(f"{case.name}: its preparation failed ({status})\n" +
                     (out + err).decode(errors="replace"))
        return True

    def run(self, case, environment):
        run = tempfile.mkdtemp(dir=self.folder(case))
        folder = os.path.join(run, "run")
        shutil.copytree(os.path.join(self.folder(case), "in"), folder,
                        symlinks=True)
        state = os.path.join(run, "state")
        open(state, "wb").write(b"\0" * 8)
        status, out, err = self.shell(
            folder, case.line,
            {**environment, "VG_FAULT_STATE": state,
             "VG_FAULT_DEPTH": str(self.options.depth)}, False)
        outcome = Outcome(status, plain(out), err, tree(folder),
                          open(state, "rb").read(1) != b"\0")
        shutil.rmtree(run)
        return outcome

    def record(self, case):
        """Sites of the undisturbed run, {hash: line}. What differs between
        three such runs is not compared later."""
        path = os.path.join(self.folder(case), "sites")
        outcomes = [self.run(case, {"VG_FAULT_RECORD": path})
                    for _ in range(3)]
        case.reference = outcomes[0]
        case.before = tree(os.path.join(self.folder(case), "in"))
        if case.reference.status != case.status:
            sys.exit(f"{case.name}: status {case.reference.status} without a "
                     f"fault\n{case.reference.err.decode(errors='replace')}")
        for other in outcomes[1:]:
            if other.out != case.reference.out:
                case.varying.add("")
            for name, value in case.reference.files.items():
                if other.files.get(name) != value:
                    if not value.startswith(b"text "):
                        sys.exit(f"{case.name}: {name} differs without a fault")
                    case.varying.add(name)
        lines = {}
        for line in open(path, errors="replace"):
            if re.fullmatch(r"[0-9a-f]{16} \w+( [^ ]+\+[0-9a-f]+)+\n", line):
                lines[line[:16]] = line.strip()
        return lines

    def complaint(self, case, outcome, function):
        """What is wrong with the outcome, or None."""
        want, text = case.reference, outcome.err.decode(errors="replace")
        if outcome.status == 124 or outcome.status == 137:
            return "still running after two minutes"
        if outcome.status < 0 or outcome.status > 127:
            return f"ended by signal {outcome.status & 127}"
        if re.search(r"signal \d+|[Ss]egmentation|Aborted|core dumped", text):
            return "a process ended by a signal"
        # If the removal of a hidden folder fails, the next run removes it.
        if function in CLEANING:
            for name in [n for n in outcome.files if re.search(r"(^|/)\.", n)]:
                del outcome.files[name]
        # A task that cannot be kept is computed again by a resumed run.
        changed = sorted(
            n for n in set(outcome.files) | set(want.files)
            if outcome.files.get(n) != want.files.get(n)
            and not n.startswith("run/records/")
            and not (n in outcome.files and n in case.varying))
        if outcome.status == want.status:
            if not changed and (outcome.out == want.out or "" in case.varying):
                return None
            if outcome.status == 0:
                if changed:
                    return "status 0, and other files: " + ", ".join(changed[:5])
                lines = set(want.out.split(b"\n"))
                new = [x for x in outcome.out.split(b"\n") if x not in lines
                       and b"not all tasks were stored there" not in x]
                if not new:
                    return None
                return "status 0, and another output: " + b" | ".join(
                    new[:3]).decode(errors="replace")
        if outcome.status == 0:
            return "status 0 instead of a failure"
        incomplete = re.findall(
            r"(\S+): the log could not be written|(standard output) could not "
            "be written", text)
        if incomplete and not set(changed) - {name for name, _ in incomplete}:
            return None
        if not text.strip():
            return f"status {outcome.status} without a message"
        left = [n for n in outcome.files if n not in case.before]
        lost = [n for n in case.before
                if outcome.files.get(n) != case.before[n]
                and n != "run/run.lock"]
        if lost:
            return "input changed: " + ", ".join(lost[:5])
        # Logs and the tasks of a run are kept for the user, and with a message
        # also hidden folders.
        left = [n for n in left if not re.match(r"run(/|\.log)", n)]
        # A sweep with a failed case has tables that say so.
        if "could not be restored" in text or "cases of the sweep" in text:
            return None
        if re.search(r"the next run|resume", text):
            left = [n for n in left if not re.search(r"(^|/)\.", n)]
        if [n for n in left if n[-1] != "/" or re.search(r"(^|/)\.", n)]:
            return "files after a failure: " + ", ".join(left[:5])
        return None


def module_path(program, module):
    folders = [os.path.dirname(program),
               os.path.join(os.path.dirname(os.path.dirname(program)), "lib")]
    return next((os.path.join(f, m) for f in folders for m in
                 sorted(os.listdir(f)) if m.startswith(module)), "")


def sites_of(program, sites, pattern):
    """Sites with a frame in a source whose name begins with the pattern; not
    those of gcov, which writes its counts."""
    offsets, found, of_gcov = {}, set(), set()
    for line in sites.values():
        for frame in line.split()[2:]:
            module, offset = frame.rsplit("+", 1)
            offsets.setdefault(module, set()).add(offset)
    for module, wanted in offsets.items():
        answer = subprocess.run(
            ["addr2line", "-afise", module_path(program, module)],
            input="\n".join(sorted(wanted)), capture_output=True, text=True)
        at = ""
        for line in answer.stdout.split("\n"):
            if line.startswith("0x"):
                at = f"{module}+{int(line, 16):x}"
            elif "gcov" in line:
                of_gcov.add(at)
            elif re.match(pattern, line):
                found.add(at)
    return {s: line for s, line in sites.items()
            if found & set(line.split()[2:])
            and not of_gcov & set(line.split()[2:])}


def name_frames(program, line):
    """The frames of a site with names of functions."""
    names = []
    for frame in line.split()[2:]:
        module, offset = frame.rsplit("+", 1)
        path = module_path(program, module)
        answer = subprocess.run(["addr2line", "-fse", path, "0x" + offset],
                                capture_output=True, text=True).stdout.split()
        names.append(answer[0] if answer else frame)
    return line.split()[1] + " < " + " < ".join(names)


def in_share(site, share):
    part, parts = (int(x) for x in share.split("/"))
    return int(site, 16) // 7 % parts == part - 1


def run_case(runner, case, options, pool, known):
    if not runner.prepare(case):
        print(f"{case.name}: skipped")
        return 0, 0, 0
    sites = runner.record(case)
    if options.of:
        sites = sites_of(runner.program, sites, options.of)
    if options.list:
        for line in sites.values():
            print(line.split()[0], name_frames(runner.program, line))
    chosen = [s for s in sorted(sites) if in_share(s, options.share)
              and s not in known]
    known.update(chosen)
    if options.site:
        chosen = [s for s in options.site if s in sites]
    jobs = {}
    for site in chosen:
        for sticky in "0" if options.of else "01":
            if sticky == "1" and sites[site].split()[1] in (
                    "read", "pread", "fread", "close", "fclose", "unlink",
                    "unlinkat", "rmdir", "opendir", "fdopendir"):
                continue
            jobs[pool.submit(runner.run, case,
                             {"VG_FAULT_SITE": site,
                              "VG_FAULT_STICKY": sticky})] = (site, sticky)
    n_fault = n_failed = 0
    for job in concurrent.futures.as_completed(jobs):
        site, sticky = jobs[job]
        outcome = job.result()
        n_failed += outcome.failed
        wrong = runner.complaint(case, outcome, sites[site].split()[1])
        if options.verbose:
            print(site, sticky, outcome.status, wrong, outcome.out.decode()[-900:],
                  outcome.err.decode(errors="replace")[-300:])
        if wrong:
            n_fault += 1
            print(f"FAULT {case.name} {site} "
                  f"{'all later' if sticky == '1' else 'one'}: {wrong}\n"
                  f"  {name_frames(runner.program, sites[site])}\n  " +
                  outcome.err.decode(errors="replace")[-240:].strip().replace(
                      "\n", "\n  "), flush=True)
    print(f"{case.name}: {len(sites)} sites, {len(chosen)} chosen, "
          f"{len(jobs)} runs, {n_failed} with a failed call, {n_fault} faults",
          flush=True)
    return len(chosen), len(jobs), n_fault


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--vanguard", required=True)
    parser.add_argument("--library", required=True)
    parser.add_argument("--library-program", default="")
    parser.add_argument("--depth", type=int, default=3)
    parser.add_argument("--case", action="append")
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--share", default="1/1")
    parser.add_argument("--of")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--site", action="append")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("-v", "--verbose", action="store_true")
    parser.add_argument("folder", nargs="?")
    options = parser.parse_args()
    options.library = os.path.realpath(options.library)
    cases = read_cases(os.path.join(HERE, "cases.txt"))
    if options.case:
        cases = [c for c in cases if c.name in options.case]
    if options.short:
        cases = [c for c in cases if c.is_short]
    if options.folder:
        os.makedirs(options.folder, exist_ok=True)
    total, known = [0, 0, 0], set()
    with tempfile.TemporaryDirectory(dir=options.folder) as root, \
            concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runner = Runner(options, root)
        for case in cases:
            total = [a + b for a, b in
                     zip(total, run_case(runner, case, options, pool,
                                       known))]
    print(f"{len(cases)} cases: {total[0]} sites, {total[1]} runs, "
          f"{total[2]} faults")
    sys.exit(total[2] > 0)


if __name__ == "__main__":
    main()
