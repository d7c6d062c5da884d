# SPDX-License-Identifier: LGPL-3.0-or-later
# Ctrl-C stops the calls of Python's module that take long.
needs tetgen
mkdir files
python interrupt.py files
exits 0
cat out
