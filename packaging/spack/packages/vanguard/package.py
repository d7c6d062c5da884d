# SPDX-License-Identifier: LGPL-3.0-or-later
"""Spack recipe. To use it from these sources:

    spack repo add packaging/spack
    spack install vanguard               # the release
    spack install vanguard@main +cad +portal
    spack dev-build vanguard@main        # in the top folder of the sources

The sources come from the repository that contains this file.
"""
import os

from spack.package import *

TOP = os.path.abspath(os.path.join(os.path.dirname(__file__), *[os.pardir] * 4))


class Vanguard(CMakePackage):
    """Parallel unstructured mesh generator for aerodynamics: viscous layers on
    walls, tetrahedra elsewhere, on threads and MPI ranks."""

    homepage = "file://" + os.path.join(TOP, "README.md")
    git = "file://" + TOP

    license("LGPL-3.0-or-later", checked_by="vanguard")

    version("main", branch="main")
    version("0.2.0", tag="v0.2.0")

    variant("mpi", default=True, description="Runs on several processes")
    variant("metis", default=True,
            description="Other decompositions, partitions for solvers")
    variant("hdf5", default=True, description="CGNS files")
    variant("cad", default=True, description="STEP, IGES and BREP files")
    variant("tetgen", default=False,
            description="Helper program with TetGen (AGPL)")
    variant("wrap", default=False, description="Helper program with CGAL (GPL)")
    variant("portal", default=True, description="vanguard serve")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("zlib-api")
    depends_on("jansson")
    depends_on("hwloc@2:")
    depends_on("xxhash@0.8:")
    depends_on("lapack")
    depends_on("netlib-lapack+lapacke")
    depends_on("mpi", when="+mpi")
    depends_on("metis@5:", when="+metis")
    depends_on("hdf5", when="+hdf5")
    depends_on("opencascade@7.6.0:7.7", when="+cad")
    depends_on("tetgen@1.5.0", when="+tetgen")
    depends_on("cgal@5.5:5", when="+wrap")
    depends_on("gmp", when="+wrap")
    depends_on("mpfr", when="+wrap")
    depends_on("libmicrohttpd", when="+portal")

    def cmake_args(self):
        parts = ("mpi", "metis", "hdf5", "cad", "tetgen", "wrap", "portal")
        return [self.define("BUILD_TESTING", False)] + [
            self.define_from_variant("VG_" + part.upper(), part)
            for part in parts
        ]
