# SPDX-License-Identifier: LGPL-3.0-or-later
"""Random calls of the module in any order, with right and wrong arguments. Each
call returns or raises one of its documented exceptions; arrays that were
received stay as they were; a job still makes its mesh afterwards.
calls.py FOLDER [SEED [JOBS]]"""
import os
import random
import sys
import threading

import numpy as np
import vanguard
from shapes import cube

ALLOWED = (vanguard.Error, ValueError, TypeError)
POINTS, TRIANGLES, PATCHES = cube(2)


class Own(Exception):
    """Raised by callbacks."""


class Walk:
    """One job, the meshes that it has made, and arrays of them."""

    def __init__(self, rng, folder):
        self.rng, self.folder = rng, folder
        self.job, self.meshes, self.kept, self.log = vanguard.Job(), [], [], []
        self.done = {"returned": 0}

    def call(self, function, *arguments, **named):
        self.log.append("%s %.200r %.200r" % (
            getattr(function, "__qualname__", function), arguments, named))
        try:
            result = function(*arguments, **named)
            self.done["returned"] += 1
            return result
        except ALLOWED as error:
            kind = getattr(error, "kind", type(error).__name__)
            self.done[kind] = self.done.get(kind, 0) + 1
            assert str(error) and repr(error), type(error)
        except Own:
            self.done["callback"] = self.done.get("callback", 0) + 1
        return None

    # --- arguments ---

    def array(self, good):
        """The array, or one that is wrong in some way."""
        a = np.array(good)
        integral = a.dtype.kind == "i"
        return self.rng.choice([
            lambda: good, lambda: good, lambda: good, lambda: a.tolist(),
            lambda: a[::-1], lambda: a[:, ::-1] if a.ndim > 1 else a[::-1],
            lambda: a[:0], lambda: a[:1], lambda: a[:-1], lambda: a.T,
            lambda: a.ravel(), lambda: a[None], lambda: a * 1j,
            lambda: a.astype(np.float32), lambda: a.astype(np.int8),
            lambda: a.astype(np.uint64), lambda: a.astype(">i4"),
            lambda: a.astype(object), lambda: a.astype(str),
            lambda: a > 0, lambda: -1 - a, lambda: a + 2**32,
            lambda: a * (2**31 if integral else 1e308),
            lambda: a if integral else a * np.nan,
            lambda: a if integral else a * np.inf,
            lambda: np.asfortranarray(a), lambda: [[1, 2], [3]],
            lambda: None, lambda: "text", lambda: 5, lambda: {}, lambda: [None],
            lambda: np.broadcast_to(a[:1], a.shape)])()

    def text(self):
        return self.rng.choice(["wing", "", "growth", "a\0b", "\udcff", "ü" * 300,
                                "x" * 10000, "%s%n", "../..", "/", None, 5,
                                b"bytes", "1e", "nan", "-", "a,b", "\n"])

    def value(self):
        return self.rng.choice([
            0, 1, -1, 0.5, 1.3, 1e300, float("nan"), float("inf"), True, None,
            "yes", "mixed", [1, 2], [], [[1]], np.float32(0.3), np.int64(7),
            np.array([3, 4]), np.zeros((2, 2)), {}, object(), 2**70,
            self.text()])

    def path(self):
        return self.rng.choice([
            os.path.join(self.folder, name) for name in (
                "missing.stl", "empty.stl", "garbage.stl", "garbage.deck",
                "good.lb8.ugrid", "good.lb8.ugrid", "none/x")] + [
            self.folder, self.text()])

    # --- calls ---

    def settings(self):
        job, rng = self.job, self.rng
        name = rng.choice([s["name"] for s in vanguard.settings()] + ["nothing"])
        name = rng.choice([name, "hmax", "layers", "first", "cells", "threads"])
        good = {"hmax": 0.3, "layers": True, "first": 0.05, "cells": "mixed",
                "threads": 2}
        value = rng.choice([good.get(name, self.value()), self.value()])
        if name in ("run_dir", "out", "log", "resume", "helpers", "write"):
            return
        rng.choice([
            lambda: self.call(job.set, **{name: value}),
            lambda: self.call(job.get, rng.choice([name, self.text()])),
            lambda: self.call(job.add, rng.choice([
                "sources", "patches", "layers", "farfield", "none",
                self.text()]), **{rng.choice([
                    "kind", "x0", "h0", "id", "name"]): self.value()}),
            lambda: self.call(job.add, "sources", kind="point", x0=0.5, y0=0.5,
                              z0=0.5, h0=0.2),
            lambda: self.call(job.patch, rng.choice([10, 14, 99, self.value()]),
                              bc=rng.choice([None, 4, 1, self.value()]),
                              name=rng.choice(["p", self.text()])),
            lambda: self.call(job.deck, rng.choice([
                "A deck\\n", "title\\n&settings\\n", "{}", self.text()]))])()

    def input(self):
        job, rng = self.job, self.rng
        rng.choice([
            lambda: self.call(job.surface, POINTS, TRIANGLES, PATCHES),
            lambda: self.call(job.surface, self.array(POINTS),
                              self.array(TRIANGLES), self.array(PATCHES),
                              self.text()),
            lambda: self.call(job.surface, POINTS, self.array(TRIANGLES)),
            lambda: self.call(job.surface, POINTS, TRIANGLES,
                              self.array(PATCHES)),
            lambda: self.call(job.open, self.path()),
            lambda: self.call(job.open, self.path(), self.path()),
            lambda: self.call(job.surface_of, self.value())])()

    def sizes(self):
        job, rng = self.job, self.rng
        x = np.array([[0.5, 0.5, 0.5], [0.2, 0.2, 0.2]])

        def fails(*unused):
            raise Own

        tensors = np.array([np.eye(3) * 9] * 2)
        rng.choice([
            lambda: self.call(job.size_points, self.array(x),
                              self.array(np.array([0.2, 0.4]))),
            lambda: self.call(job.metric_points, self.array(x),
                              self.array(tensors), self.array(np.array(
                                  [[0, 1, 0, 1]]))),
            lambda: self.call(job.metric_points, x, tensors),
            lambda: self.call(job.size_function, rng.choice([
                None, fails, 5, lambda x, y, z: 0.3,
                lambda x, y, z: self.value()])),
            lambda: self.call(job.metric_function, rng.choice([
                None, fails, "text", lambda x, y, z: np.eye(3) * 9,
                lambda x, y, z: self.value()]))])()

    def mesh(self):
        job, rng = self.job, self.rng

        def again(phase, done, expected):
            for unused in range(2):
                rng.choice([self.settings, self.input, self.sizes, self.mesh,
                            self.close, self.ask, job.cancel])()

        def fails(*unused):
            raise Own

        progress = rng.choice([
            None, None, None, again, fails, lambda *unused: True,
            lambda *unused: self.value() and False, 5, "text"])
        name = rng.choice(["mesh"] * 4 + ["check", "make_surface", "forecast",
                                       "forecast"])
        if name == "forecast":
            self.forecast(progress)
        else:
            result = self.call(getattr(job, name), progress)
            if isinstance(result, vanguard.Mesh):
                self.meshes.append(result)
            elif result is not None:
                self.keep_surface(result)

    def forecast(self, progress):
        machine = [self.rng.choice([1, 1, 1, 4, 4, self.value()]),
                   self.rng.choice([0, 0, 0, 2, 2, self.value()])]
        result = self.call(self.job.forecast, *machine, progress)
        if result is not None:
            self.made("forecast")
            assert result.n_cell > 0 and result.memory > 0, result

    def made(self, what):
        self.done[what] = self.done.get(what, 0) + 1

    def keep_surface(self, surface):
        self.made("surface")
        assert repr(surface) and surface.n_body >= 0
        for name in ("points", "triangles", "triangle_patches"):
            a = getattr(surface, name)
            self.kept.append((name, a, a.copy()))

    def surface(self):
        result = self.call(self.job.boundary)
        if result is not None:
            self.keep_surface(result)

    def report(self):
        form = self.rng.choice(["json", "json", "text", "html", self.text()])
        ask = self.rng.choice([self.job] + self.meshes[-1:]).report
        result = self.call(ask, form)
        if result is not None:
            assert isinstance(result, str if form == "text" else dict), form

    def read(self):
        mesh = self.call(vanguard.read, self.path())
        if mesh is not None:
            self.made("mesh of a file")
            self.meshes.append(mesh)

    def ask(self):
        if not self.meshes:
            return
        mesh, rng = self.rng.choice(self.meshes), self.rng
        name = rng.choice(["points", "tetrahedra", "pyramids", "prisms",
                           "triangles", "quadrilaterals", "triangle_patches",
                           "quadrilateral_patches", "patches", "notes",
                           "quality", "walls", "wall_points", "pieces",
                           "to_meshio_dict", "to_vtk_arrays", "repr", "write"])
        if name == "write":
            stem = os.path.join(self.folder, "out", "m")
            result = self.call(mesh.write, rng.choice([stem, stem, "none/m", "", "a\0b",
                                             "x" * 5000, None, 5]),
                               rng.choice(["b8.ugrid", ["vtu", "su2"], None, [],
                                           "nothing", self.value()]))
        elif name == "repr":
            result = self.call(repr, mesh) and None
            repr(self.job)
        elif name == "pieces":
            result = self.call(lambda: [a for piece in mesh.pieces()
                                        for a in piece.values()])
        else:
            result = self.call(lambda: getattr(mesh, name))
            if callable(result):
                result = self.call(result)
        if isinstance(result, dict):
            result = list(result.values())
        for a in result if isinstance(result, (list, tuple)) else [result]:
            if isinstance(a, np.ndarray):
                self.kept.append((name, a, a.copy()))

    def close(self):
        self.call(self.job.close)
        if self.job._job is None:
            self.meshes = self.meshes[-2:]

    def replace(self):
        """Another job, while meshes and arrays of this one remain."""
        self.job = vanguard.Job()

    def forget(self):
        self.meshes = self.meshes[:self.rng.randrange(3)]

    def other_thread(self):
        thread = threading.Thread(target=self.rng.choice(
            [self.settings, self.input, self.ask, self.mesh]))
        thread.start()
        self.rng.choice([self.settings, self.ask])()
        thread.join()

    def step(self):
        self.rng.choices(
            [self.settings, self.input, self.sizes, self.mesh, self.ask,
             self.surface, self.report, self.read, self.close, self.replace,
             self.forget, self.other_thread],
            [6, 6, 3, 5, 10, 1, 1, 1, 0.4, 0.4, 1, 1])[0]()

    def check(self):
        for name, a, before in self.kept:
            assert np.array_equal(a, before, equal_nan=True), name


def files(folder):
    os.mkdir(os.path.join(folder, "out"))
    for name, data in (("empty.stl", b""), ("garbage.stl", b"\xff" * 200),
                       ("garbage.deck", b"no deck\n\x00\x01")):
        with open(os.path.join(folder, name), "wb") as out:
            out.write(data)
    job = vanguard.Job()
    job.surface(POINTS, TRIANGLES, PATCHES)
    job.set(hmax=0.4)
    job.mesh().write(os.path.join(folder, "good"), "lb8.ugrid")


def main(folder, seed=1, jobs=60):
    vanguard.prepare()
    files(folder)
    os.chdir(os.path.join(folder, "out"))
    done = {}
    for i in range(int(jobs)):
        walk = Walk(random.Random(1000 * int(seed) + i), folder)
        try:
            for unused in range(40):
                walk.step()
                walk.check()
        except BaseException:
            print("seed %s, job %d:\n%s" % (seed, i, "\n".join(walk.log[-15:])))
            raise
        for kind, n in walk.done.items():
            done[kind] = done.get(kind, 0) + n
    print(", ".join("%s %d" % item for item in sorted(done.items())))
    for kind in ("returned", "input", "usage", "busy", "ValueError",
                 "TypeError", "callback", "stopped"):
        assert done.get(kind), "no call ended with " + kind
    for what in ("forecast", "surface", "mesh of a file"):
        assert done.get(what), "no call made a " + what
    job = vanguard.Job()
    job.surface(POINTS, TRIANGLES, PATCHES)
    assert abs(job.mesh().quality["volume"] - 1) < 1e-9


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), *sys.argv[2:])
