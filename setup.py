# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wheel of the Python module alone: `pip install .` after the library was
installed with CMake. The module finds the library on its own (_find in
python/vanguard.py.in)."""
import os
import re

from setuptools import setup

here = os.path.dirname(os.path.abspath(__file__))
with open(os.path.join(here, "python", "vanguard.py.in"),
          encoding="utf-8") as source:
    text = source.read()
with open(os.path.join(here, "CMakeLists.txt"), encoding="utf-8") as source:
    version = re.search(r"project\(vanguard VERSION ([\d.]+)",
                        source.read()).group(1)
text = text.replace("@VG_LIBRARY_FROM_PYTHON@", "").replace(
    "@PROJECT_VERSION@", version)
# pip builds in its own copy of the sources or in this folder.
folder = os.path.join("build", "python")
os.makedirs(os.path.join(here, folder), exist_ok=True)
with open(os.path.join(here, folder, "vanguard.py"), "w",
          encoding="utf-8") as module:
    module.write(text)

setup(version=version, package_dir={"": folder}, py_modules=["vanguard"])
