# SPDX-License-Identifier: LGPL-3.0-or-later
# Meshes passed from Python to meshio and VTK, as VTK and Gmsh see them.
needs tetgen
mkdir files
python meshio_files.py files
exits 0
