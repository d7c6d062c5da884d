# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ctrl-C ends mesh() with KeyboardInterrupt. interrupt.py FOLDER

Whether a call was stopped is seen from its result, not from the time that it
took: a run that was stopped leaves no mesh, and one that was not has a mesh."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import vanguard
from shapes import job_of, run

LONG = {"hmax": 0.015, "threads": 1}   # a run of half a minute


def has_mesh(job):
    counts = vanguard._Counts()
    return vanguard._lib.vanguard_count(
        job._job, vanguard.c.byref(counts)) == 0


def mesh_until_interrupt(way):
    """The child process: says when it meshes, and how that ended."""
    job = job_of(10, **LONG)

    def say(text):
        sys.stdout.write(text + "\n")
        sys.stdout.flush()

    def progress(phase, done, expected):
        if phase == "fill" and done:
            say("running")

    say("running" if way == "plain" else "starts")
    try:
        job.mesh(*[progress] if way == "progress" else [])
        say("no exception")
    except KeyboardInterrupt:
        say("KeyboardInterrupt " + ("too late" if has_mesh(job) else "in time"))
    job.set(hmax=0.2)
    say("then %d points" % job.mesh().counts.n_point)


def interrupted_child(way, signals=1):
    child = subprocess.Popen([sys.executable, __file__, "--child", way],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             text=True)
    try:
        while child.stdout.readline() != "running\n":
            assert child.poll() is None, child.stderr.read()
        if way == "plain":   # it says so before it calls mesh()
            time.sleep(2)
        start = time.monotonic()
        for unused in range(signals):
            child.send_signal(signal.SIGINT)
            time.sleep(0.02)
        line = "running\n"
        while line == "running\n":
            line = child.stdout.readline()
        print("%s: raised after %.2f s" % (way, time.monotonic() - start))
        assert line == "KeyboardInterrupt in time\n", (
            line, child.stderr.read())
        assert child.stdout.readline() == "then %d points\n" % job_of(
            10, hmax=0.2).mesh().counts.n_point
        assert child.wait() == 0
        assert child.stderr.read() == ""
    finally:
        child.kill()
        child.communicate()


def test_without_progress():
    interrupted_child("plain")


def test_with_progress():
    interrupted_child("progress")


def test_twice():
    interrupted_child("progress", signals=2)


def raised_by(function, *arguments):
    try:
        function(*arguments)
    except BaseException as error:
        return error
    raise AssertionError("no exception")


def test_exception_of_a_callback():
    """Also one that is no Exception, and from a size function."""
    for error in KeyboardInterrupt, SystemExit, ZeroDivisionError:
        job = job_of(6)

        def fail(*unused):
            raise error("own")

        assert type(raised_by(job.mesh, fail)) is error
        assert not has_mesh(job)
        job.size_function(fail)
        assert type(raised_by(job.mesh)) is error
        job.size_function(None)
        assert job.mesh().counts.n_tet


class Timeout(Exception):
    pass


def test_handler():
    """What a handler raises stops the run. A handler that returns does not."""
    def handler(number, frame):
        if raises:
            raise Timeout

    job, before = job_of(6), signal.signal(signal.SIGUSR1, handler)
    threads = []

    def progress(phase, done, expected):
        if not threads:
            threads.append(threading.current_thread())
            os.kill(os.getpid(), signal.SIGUSR1)
        return 0

    try:
        raises = False
        assert job.mesh(progress).counts.n_tet
        assert threads[0] is not threading.main_thread()
        raises = True
        job.set(**LONG)
        del threads[:]
        assert type(raised_by(job.mesh, progress)) is Timeout
        assert not has_mesh(job)
    finally:
        signal.signal(signal.SIGUSR1, before)


def test_other_thread():
    """Another thread calls the library itself, and cancel stops it."""
    job, found = job_of(6, **LONG), []

    def progress(phase, done, expected):
        if phase == "fill":
            job.cancel()

    thread = threading.Thread(target=lambda: found.append(
        raised_by(job.mesh, progress)))
    thread.start()
    thread.join()
    assert type(found[0]) is vanguard.Stopped, found


def test_handler_cancels():
    job = job_of(6, **LONG)
    before = signal.signal(signal.SIGUSR1, lambda *unused: job.cancel())

    def progress(phase, done, expected):
        if phase == "fill":
            os.kill(os.getpid(), signal.SIGUSR1)

    try:
        assert type(raised_by(job.mesh, progress)) is vanguard.Stopped
    finally:
        signal.signal(signal.SIGUSR1, before)


def test_write(folder):
    """write() is stopped too: all of its files appear, or none."""
    mesh = job_of(10, hmax=0.03).mesh()
    whole = os.path.join(folder, "whole")
    os.mkdir(whole)
    mesh.write(os.path.join(whole, "cube"), ["b8.ugrid", "vtu", "cogsg"])
    files = sorted(os.listdir(whole))

    def handler(number, frame):
        raise Timeout

    before = signal.signal(signal.SIGALRM, handler)
    stopped = 0
    try:
        for i, seconds in enumerate(0.002 * 1.5**np.arange(14)):
            part = os.path.join(folder, "part%d" % i)
            os.mkdir(part)
            try:
                signal.setitimer(signal.ITIMER_REAL, seconds)
                mesh.write(os.path.join(part, "cube"),
                           ["b8.ugrid", "vtu", "cogsg"])
                signal.setitimer(signal.ITIMER_REAL, 0)
            except Timeout:
                stopped += 1
            found = sorted(os.listdir(part))
            assert found in ([], files), found
            for name in found:
                with open(os.path.join(part, name), "rb") as a, open(
                        os.path.join(whole, name), "rb") as b:
                    assert a.read() == b.read(), name
    finally:
        signal.signal(signal.SIGALRM, before)
    print("%d of %d writes were interrupted" % (stopped, i + 1))
    assert mesh.quality["volume"] > 0.99


def test_cancelled_write(folder):
    """write() can be cancelled: one of these attempts is stopped."""
    mesh = job_of(10, hmax=0.03).mesh()
    for i in range(50):
        part = os.path.join(folder, "cancelled%d" % i)
        os.mkdir(part)
        ends = threading.Event()

        def cancel():
            while not ends.wait(0.001):
                mesh._job.cancel()

        thread = threading.Thread(target=cancel)
        thread.start()
        try:
            mesh.write(os.path.join(part, "cube"), "vtu,b8.ugrid,meshb")
        except vanguard.Stopped as error:
            assert "nothing was written" in str(error), error
            assert os.listdir(part) == []
            break
        finally:
            ends.set()
            thread.join()
    else:
        raise AssertionError("no write was stopped")
    mesh.write(os.path.join(part, "cube"), "vtu")
    assert "cube.vtu" in os.listdir(part)


if __name__ == "__main__":
    if sys.argv[1] == "--child":
        mesh_until_interrupt(sys.argv[2])
    else:
        run(globals(), *sys.argv[1:])
