# SPDX-License-Identifier: LGPL-3.0-or-later
# Sectors of a disk, for the cases of periodic patches.

# sector NAME N R [WAVE]: the part between the radii R and 1 of a disk, 1/N of a
# turn, with coordinates of seven digits. The inner side has a wave of this
# height in the direction of the turn.
sector() {
  awk -v n="$2" -v r0="$3" -v wave="${4:-0}" '
    function vertex(i, j, k,  r, t) {
      r = r0 + wave * sin(6.2831853 * (j % 8) / 8 + 1) * k * (4 - k) / 4
      r += (1 - r) * i / 6
      t = 2 * atan2(0, -1) / n * j / 8
      printf "vertex %.7g %.7g %.7g\n", r * cos(t), r * sin(t), k / 8
    }
    function corner(d, e, u, v) {
      if (d == 1) vertex(u, e * 8, v)
      if (d == 2) vertex(e * 6, u, v)
      if (d == 3) vertex(u, v, e * 4)
    }
    function facet(d, e, a, b, c, f, g, h) {
      print "facet normal 0 0 0\nouter loop"
      corner(d, e, a, b); corner(d, e, c, f); corner(d, e, g, h)
      print "endloop\nendfacet"
    }
    function side(name, d, e,  u, v, nu, nv) {
      nu = d == 2 ? 8 : 6
      nv = d == 3 ? 8 : 4
      print "solid " name
      for (u = 0; u < nu; u++) for (v = 0; v < nv; v++) {
        facet(d, e, u, v, u + 1, v, u + 1, v + 1)
        facet(d, e, u, v, u + 1, v + 1, u, v + 1)
      }
      print "endsolid " name
    }
    BEGIN {
      side("lo", 1, 0); side("hi", 1, 1)
      if (r0 > 0) side("in", 2, 0)
      side("out", 2, 1); side("bot", 3, 0); side("top", 3, 1)
    }' </dev/null >"$1.stl"
}

# deck NAME LINE...: a deck with the table.
deck() {
  local name=$1
  shift
  { printf 'p\n\nperiodic\n'; printf '%s\n' "$@"; } >"$name.deck"
}
