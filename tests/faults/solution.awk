# SPDX-License-Identifier: LGPL-3.0-or-later
# Two fields at the points of a .mesh, as a .csv.
BEGIN { print "\"x\",\"a\",\"b\"" }
at && n < count {
  print $1 "," $1 * $1 * $1 + $2 * $3 "," $2 * $2 * $2 - $1 * $3 * $3
  n++
}
is_count { count = $1; at = 1; is_count = 0 }
$1 == "Vertices" { is_count = 1 }
