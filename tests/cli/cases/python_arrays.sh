# SPDX-License-Identifier: LGPL-3.0-or-later
# Arrays that Python has received remain valid after the next mesh and after the
# end of the job.
python arrays.py
exits 0
