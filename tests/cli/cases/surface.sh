# SPDX-License-Identifier: LGPL-3.0-or-later
# vanguard surface: a surface of sliver triangles remeshed, its files and
# report; refusals; and the same within a run of vanguard mesh.
beam() { # NAME: a bar 4 x 1 x 1, its long sides cut into needles across
  {
    for ((i = 0; i <= 40; i++)); do
      awk -v x="$i" 'BEGIN { x /= 10
        printf "v %s 0 0\nv %s 1 0\nv %s 1 1\nv %s 0 1\n", x, x, x, x }'
    done
    echo "g side"
    for ((i = 0; i < 40; i++)); do
      for ((k = 0; k < 4; k++)); do
        a=$((4 * i + k + 1)) b=$((4 * i + (k + 1) % 4 + 1))
        echo "f $a $((b + 4)) $b"
        echo "f $a $((a + 4)) $((b + 4))"
      done
    done
    echo "g ends"
    echo "f 1 2 3"; echo "f 1 3 4"
    echo "f 161 163 162"; echo "f 161 164 163"
  } >"$1.obj"
}

beam bar
vanguard surface -q bar.obj --surface-size 0.3 --out new
exits 0
says out "bar.obj: remeshed surface"
says out "8 corners and 12 feature curves preserved, length of curves 24 -> 24"
says out "distance of the remeshed from the input surface: "
lacks out "below 20 degrees: "
exists new/bar.lb8.ugrid new/bar.mapbc new/bar.surface.vtu new/bar.surface.json
says new/bar.mapbc "side"
says new/bar.mapbc "ends"
says new/bar.surface.json '"given_from_new"'
says new/bar.surface.vtu 'Name="smallest_angle"'
says new/bar.surface.vtu 'Name="distance"'
[ "$(ls -A new | wc -l)" = 4 ] || fail "files are left behind: $(ls -A new)"
vanguard check -q new/bar.lb8.ugrid
exits 0
says out "no defects"

# The same bytes for any number of threads; nothing is overwritten.
vanguard surface -q bar.obj --surface-size 0.3 --out again -t 2 --json
exits 0
says out '"percent_edges_fit"'
same new/bar.lb8.ugrid again/bar.lb8.ugrid
vanguard surface -q bar.obj --surface-size 0.3 --out new
exits 1
says err "exists and is not overwritten"

# Sizes that depend on the direction: edges of 0.5 along x and of 0.05 across
# it, in a metric given at the corners of a box around the bar.
cat >metric.mesh <<END
MeshVersionFormatted 2
Dimension 3
Vertices
8
-1 -1 -1 0
5 -1 -1 0
-1 2 -1 0
5 2 -1 0
-1 -1 2 0
5 -1 2 0
-1 2 2 0
5 2 2 0
Tetrahedra
5
1 2 3 5 1
4 3 2 8 1
6 5 8 2 1
7 8 5 3 1
2 3 5 8 1
End
END
{
  printf 'MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n8\n1 3\n'
  for ((i = 0; i < 8; i++)); do echo "4 0 400 0 0 400"; done
  echo End
} >metric.sol
vanguard surface -q bar.obj --sizes metric.sol --write ugrid --out stretched
exits 0
says out "8 corners and 12 feature curves preserved, length of curves 24 -> 24"
lacks out "They cause poor cells"
awk 'NR == 1 { n_point = $1; n_tri = $2 }
  NR > 1 && NR <= 1 + n_point { for (k = 1; k <= 3; k++) x[NR - 1, k] = $k }
  NR > 1 + n_point && NR <= 1 + n_point + n_tri {
    for (k = 1; k <= 3; k++) {
      a = $k; b = $(k % 3 + 1)
      l = 4 * (x[a, 1] - x[b, 1])^2
      l += 400 * (x[a, 2] - x[b, 2])^2
      l += 400 * (x[a, 3] - x[b, 3])^2
      l = sqrt(l)
      n++; fit += l >= 0.71 && l <= 1.41
    }
  }
  END { exit !(n_tri > 2500 && n_tri < 4500 && fit > 0.95 * n) }' \
  stretched/bar.ugrid || fail "edges do not follow the metric"
vanguard surface -q bar.obj --sizes metric.sol --write ugrid --out stretched2 \
  -t 2
exits 0
same stretched/bar.ugrid stretched2/bar.ugrid

# A fixed patch border stays. In the folder of the input the output has
# another name.
cat >hard.deck <<'END'
needles
surface_size
0.3

patches
id  hard
1   yes
END
vanguard surface -q bar.obj --deck hard.deck --write stl
exits 0
exists bar.new.stl bar.new.mapbc
rm bar.new.*

# Invalid requests.
vanguard surface
exits 2
says err "no surface given"
vanguard surface -q none.stl
exits 1
vanguard surface -q bar.obj --feature-angle 4
exits 2
says err "feature_angle"
vanguard surface -q bar.obj --surface-size 1e-7 --out small
exits 1
says err "sizes and tolerance are in the unit of the surface"
absent small/bar.lb8.ugrid
vanguard surface -q bar.obj --write cogsg --out small
exits 1
says err "for volume meshes"
sed '$d' bar.obj >open.obj
vanguard surface -q open.obj --out holed
exits 0 # an open rim is a feature curve
vanguard check -q holed/open.lb8.ugrid
says out "open edge: "

# Sizes for a patch and for a curve; the ends have no points except those of
# the rim.
made() { # triangles of the new surface
  sed -n 's/.*triangles [0-9,]* -> \([0-9,]*\);.*/\1/p' out | tr -d ,
}
cat >end.deck <<'END'
finer ends
surface_size
0.5

surface
patch  adjacent  size
2      -       0.1
END
sed 's/^2 .*/1      2       0.1/' end.deck >rim.deck
sed 's/^2 .*/1      7       0.1/' end.deck >none.deck
sed 's/^2 .*/1      -       0/' end.deck >nothing.deck
vanguard surface -q bar.obj --surface-size 0.5 --out plain
exits 0
n_plain=$(made)
vanguard surface -q bar.obj --deck end.deck --out end
exits 0
n_end=$(made)
vanguard surface -q bar.obj --deck rim.deck --out rim
exits 0
n_rim=$(made)
[ "$n_plain" -lt "$n_rim" ] && [ "$n_rim" -le "$n_end" ] ||
  fail "$n_plain, $n_rim, $n_end triangles"
sed 's/^2 .*/sid?   e*      0.1/' end.deck >names.deck
vanguard surface -q bar.obj --deck names.deck --out names
exits 0
[ "$(made)" = "$n_rim" ] || fail "a curve given by names differs from that given by numbers"
vanguard surface -q bar.obj --deck none.deck --out none
exits 1
says err "surface: the surface has no patch 7"
vanguard surface -q bar.obj --deck nothing.deck --out nothing
exits 1
says err "has no request"

# The curve again, with edges that are longer along it than across it, except
# at corners.
sed -e 's/  size$/  size  stretch/' -e 's/^2 .*/1      2       0.1   4/' \
  end.deck >long.deck
sed 's/^1 .*/1      -       0.1   4/' long.deck >nowhere.deck
vanguard surface -q bar.obj --deck long.deck --out long
exits 0
says out "stretched triangles by aspect ratio: to 1.5"
says long/bar.surface.json '"stretched"'
n_long=$(made)
[ "$n_long" -lt "$n_rim" ] || fail "$n_rim, stretched $n_long triangles"
vanguard surface -q bar.obj --deck nowhere.deck --out nowhere
exits 1
says err "has stretch, which needs a curve; name the adjacent patch"

# Within a run.
vanguard mesh -q -p bar.obj --remesh-surface yes --surface-size 0.3 \
  --out run --write lb8.ugrid --threads 1
exits 0
says out "remeshed: "
says out "note: the surface was remeshed (remesh_surface)"
says run/bar.report.json '"remesh": {'
says run/bar.resolved.deck "remesh_surface"
vanguard mesh -q -p bar.obj --deck run/bar.resolved.deck --out rerun
exits 0
same run/bar.lb8.ugrid rerun/bar.lb8.ugrid

# Information about a surface: feature edges, and the distance from another
# surface.
vanguard check -q new/bar.lb8.ugrid --against bar.obj --vtu shown.vtu
exits 0
says out "feature curves (sharp edges, rims, borders between conditions): 12, length 24"
says out "comparison with bar.obj"
lacks out "edges within a factor"
says shown.vtu 'Name="radius_ratio"'
says shown.vtu 'Name="distance"'
printf 'Sizes of a bar\nsurface_size\n0.3\n' >size.deck
vanguard check -q new/bar.lb8.ugrid --deck size.deck --json
exits 0
# At least 95 % of the edges must match a uniform size.
jq -e '.. | .percent_edges_fit? // empty | . >= 98' out >/dev/null ||
  fail "edges do not fit: $(grep percent_edges_fit out)"
says out '"corners": 8'
says out '"edge_mean"'
vanguard check -q new/bar.lb8.ugrid --against none.stl
exits 1

# A coarse sphere in a coarse outer boundary: the tolerance of the body limits
# its edges, and does not apply to the long edges of the outer boundary.
sphere() { # NAME RADIUS ORDER: 16 x 8 facets; ORDER 1 reverses them
  awk -v name="$1" -v r="$2" -v turn="$3" '
    function put(i, j, t, f) {
      t = i * pi / 8; f = j * pi / 8
      printf "vertex %.9g %.9g %.9g\n", r * sin(t) * cos(f), \
        r * sin(t) * sin(f), i == 0 ? r : i == 8 ? -r : r * cos(t)
    }
    function facet(i, j, k, l, m, n) {
      print "facet normal 0 0 0\nouter loop"
      put(i, j)
      if (turn) { put(m, n); put(k, l) } else { put(k, l); put(m, n) }
      print "endloop\nendfacet"
    }
    BEGIN {
      pi = atan2(0, -1)
      print "solid " name
      for (i = 0; i < 8; i++) for (j = 0; j < 16; j++) {
        if (i < 7) facet(i, j, i + 1, j, i + 1, (j + 1) % 16)
        if (i > 0) facet(i, j, i + 1, (j + 1) % 16, i, (j + 1) % 16)
      }
      print "endsolid " name
    }' </dev/null
}
sphere body 1 0 >coarse.stl
vanguard surface -q coarse.stl --surface-tolerance 0.001 --surface-size 0.9
exits 0
says out "note: surface_size allows edges of 0.9, but the longest edge is 0."
says out "the tolerance 0.001 require shorter edges"
{ sphere body 1 0; sphere far 20 1; } >domain.stl
vanguard surface -q domain.stl --surface-tolerance 0.001
exits 0
says out "tolerance on the outer boundary, where the target edge length exceeds"
says out "tolerance 0.001, or 0.05 of the edge length where edges of the outer"
