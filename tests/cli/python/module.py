# SPDX-License-Identifier: LGPL-3.0-or-later
"""The module itself: import, version, text forms, lists of formats.
module.py FOLDER VERSION"""
import copy
import ctypes.util
import os
import pickle
import re
import subprocess
import sys

import numpy as np
import vanguard
from shapes import cube, job_of, run


def imported_with(library):
    """The last line of standard error of an import with this library."""
    ran = subprocess.run([sys.executable, "-c", "import vanguard"], text=True,
                         env=dict(os.environ, VANGUARD_LIBRARY=library),
                         capture_output=True)
    assert ran.returncode == 1, ran
    return ran.stderr.splitlines()[-1]


def test_import():
    error = imported_with("/nowhere/libvanguard.so.1")
    assert error.startswith("ImportError: "), error
    for part in ("/nowhere/libvanguard.so.1", "libvanguard1",
                 "VANGUARD_LIBRARY"):
        assert part in error, error
    other = ctypes.util.find_library("m")
    error = imported_with(other)
    assert error.startswith("ImportError: ") and other in error, error
    assert "same version" in error, error


def test_version(folder, version):
    assert vanguard.__version__ == version == vanguard.library_version()
    assert re.fullmatch(r"\d+\.\d+\.\d+", version), version


def test_repr():
    job = vanguard.Job()
    assert repr(job) == "<vanguard.Job: no surface, no mesh>"
    job.surface(*cube(2), name="wing")
    assert repr(job) == ("<vanguard.Job: surface 'wing' (26 points, 48 "
                         "triangles), no mesh>")
    mesh = job.mesh()
    n = len(mesh.points)
    assert repr(job).endswith("mesh of %d points>" % n), job
    assert repr(mesh) == ("<vanguard.Mesh: %d points, %d tetrahedra, 48 "
                          "triangles, 6 patches>" % (n, len(mesh.tetrahedra)))
    job.mesh()
    assert "has made another mesh" in repr(mesh)
    job.close()
    assert repr(job) == "<vanguard.Job: closed>"
    assert "its job is closed" in repr(mesh)


def failure(function, *arguments, **named):
    try:
        function(*arguments, **named)
    except (vanguard.Error, ValueError, TypeError) as error:
        return error
    raise AssertionError("no error")


def test_errors():
    error = failure(vanguard.Job().mesh)
    assert repr(error) == "vanguard.Error(%r, kind='usage')" % str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), again.status, again.kind) == (
        vanguard.Error, str(error), error.status, "usage")


def test_jobs_are_not_copied():
    job = vanguard.Job()
    for copied in (copy.copy, copy.deepcopy, pickle.dumps):
        assert "cannot be copied" in str(failure(copied, job))


def test_set_changes_all_or_nothing():
    job = vanguard.Job()
    before = job.get("growth"), job.get("first")
    failure(job.set, growth=1.4, first=0.1, bogus=3)
    assert (job.get("growth"), job.get("first")) == before


def test_arguments():
    job, x = vanguard.Job(), cube(2)
    for kind, part, function, arguments in (
            (ValueError, "null character", job.patch, (1, 4, "a\0b")),
            (ValueError, "null character", job.open, ("a\0b",)),
            (ValueError, "not an integer", job.surface, x[:2] + (x[2] + 0.5,)),
            (ValueError, "32 bits", job.surface, x[:2] + (x[2] + 2**32,)),
            (ValueError, "complex", job.surface, (x[0] * 1j,) + x[1:]),
            (ValueError, "bool", job.surface, (x[0] > 0,) + x[1:]),
            (ValueError, "object", job.size_points, ([[0, 0, None]], [1])),
            (TypeError, "bytes", job.deck, (b"bytes",)),
            (TypeError, "value of a setting", job.patch, (1, b"4")),
            (TypeError, "value of a setting", job.patch, (1, {})),
            (TypeError, "progress", job.mesh, (5,)),
            (TypeError, "size function", job.size_function, ("x",)),
            (TypeError, "pyvista or meshio", job.surface_of, ([1],))):
        error = failure(function, *arguments)
        assert isinstance(error, kind) and part in str(error), repr(error)
    job.surface(*x[:2], x[2].astype(float))   # whole numbers
    assert {p["id"] for p in job.mesh().patches} == set(range(10, 16))


def test_lists_of_formats(folder):
    mesh = job_of(2).mesh()
    stem = os.path.join(folder, "list")
    for forms in (["vtu", "b8.ugrid"], ("vtu", "b8.ugrid"), "vtu,b8.ugrid",
                  np.array(["vtu", "b8.ugrid"])):
        mesh.write(stem, forms)
        for form in "vtu", "b8.ugrid":
            os.remove(stem + "." + form)
    assert "nothing" in str(failure(mesh.write, stem, ["vtu", "nothing"]))
    assert not os.path.exists(stem + ".vtu")


if __name__ == "__main__":
    run(globals(), *sys.argv[1:])
