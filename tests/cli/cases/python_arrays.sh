# SPDX-License-Identifier: LGPL-3.0-or-later
# Arrays that Python has received remain valid after the next mesh and after the
# end of the job.
needs tetgen
python arrays.py
exits 0
