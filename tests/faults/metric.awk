# SPDX-License-Identifier: LGPL-3.0-or-later
# From a Medit mesh in text to a .sol with a metric at each of its points:
# shorter edges in z.
BEGIN { print "MeshVersionFormatted 2\nDimension 3\nSolAtVertices" }
at && n < count {
  print "0.005 0 0.005 0 0 0.02"
  n++
}
is_count { count = $1; print count "\n1 3"; at = 1; is_count = 0 }
$1 == "Vertices" { is_count = 1 }
END { print "End" }
