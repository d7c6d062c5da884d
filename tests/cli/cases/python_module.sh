# SPDX-License-Identifier: LGPL-3.0-or-later
# Import of Python's module with and without its library, its version, and the
# arguments of its calls.
needs tetgen
mkdir files
vanguard --version
version=$(sed -n '1s/^[^0-9]*\([0-9.]*\).*/\1/p' out)
python module.py files "$version"
exits 0
