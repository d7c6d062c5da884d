# SPDX-License-Identifier: LGPL-3.0-or-later
# Surfaces for the cases of faults.py.

# An octahedron with its corners at distance 1.
octahedron() {
  printf 'v %s\n' "1 0 0" "-1 0 0" "0 1 0" "0 -1 0" "0 0 1" "0 0 -1"
  echo "g body"
  printf 'f %s\n' "1 3 5" "3 2 5" "2 4 5" "4 1 5" "3 1 6" "2 3 6" "4 2 6" \
    "1 4 6"
}

# The same with a fin on an edge, which has a free end.
finned() {
  octahedron
  printf 'v %s\n' "1.5 1.5 0" "1.5 1 0.5"
  echo "g fin"
  printf 'f %s\n' "1 3 7" "1 7 8"
}

# An octahedron and a fin that crosses it.
crossed() {
  octahedron
  printf 'v %s\n' "-1.5 0.1 -0.05" "1.5 0.15 -0.07" "0.1 0.2 1.5"
  echo "g fin"
  echo "f 7 8 9"
}

# Half of an octahedron, open at y = 0, with a fin that ends there.
half_finned() {
  printf 'v %s\n' "1 0 0" "-1 0 0" "0 1 0" "0 0 1" "0 0 -1" "1.5 0 0" "1.5 0.5 0"
  echo "g body"
  printf 'f %s\n' "1 3 4" "3 2 4" "3 1 5" "2 3 5"
  echo "g fin"
  printf 'f %s\n' "1 6 7" "1 7 3"
}

# An octahedron around a smaller one.
nested() {
  octahedron
  printf 'v %s\n' "0.4 0 0" "-0.4 0 0" "0 0.4 0" "0 -0.4 0" "0 0 0.4" "0 0 -0.4"
  echo "g in"
  printf 'f %s\n' "7 9 11" "9 8 11" "8 10 11" "10 7 11" "9 7 12" "8 9 12" \
    "10 8 12" "7 10 12"
}

# The octahedron as STL with defects: a triangle is missing, one is reversed, and one
# is there twice.
defects() {
  octahedron | awk '
    $1 == "v" { corner[++n] = $2 " " $3 " " $4 }
    $1 == "f" { k++; put($2, $3, $4, k == 2) }
    function put(a, b, c, is_reversed) {
      if (k == 8) return
      if (is_reversed) { t = a; a = b; b = t }
      text = "facet normal 0 0 0\nouter loop\nvertex " corner[a] \
        "\nvertex " corner[b] "\nvertex " corner[c] "\nendloop\nendfacet"
      print text
      if (k == 5) print text
    }
    BEGIN { print "solid defects" }
    END { print "endsolid defects" }'
}
