# SPDX-License-Identifier: LGPL-3.0-or-later
# Random calls of Python's module in any order, also under ASan.
needs tetgen
mkdir files
python calls.py files
exits 0
cat out
