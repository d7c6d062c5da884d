# SPDX-License-Identifier: LGPL-3.0-or-later
# Grid families: a small body meshed at three levels follows the rule;
# settings without effect are reported; and edges across gaps. The input
# ellipsoids are finer than any level requests, because coarser facets would
# show in the edge counts.
needs tetgen
body() { # NAME X Y Z DX: an ellipsoid of these half axes, moved by DX
  awk -v n=48 -v x="$2" -v y="$3" -v z="$4" -v dx="$5" 'BEGIN {
    pi = atan2(0, -1)
    printf "v %.15g 0 %.15g\n", dx, z
    for (j = 1; j < n; j++)
      for (i = 0; i < 2 * n; i++)
        printf "v %.15g %.15g %.15g\n",
          dx + x * sin(pi * j / n) * cos(pi * i / n),
          y * sin(pi * j / n) * sin(pi * i / n), z * cos(pi * j / n)
    printf "v %.15g 0 %.15g\n", dx, -z
    last = 2 + (n - 1) * 2 * n
    for (i = 0; i < 2 * n; i++) {
      k = (i + 1) % (2 * n)
      print "f", 1, 2 + i, 2 + k
      for (j = 0; j < n - 2; j++) {
        a = 2 + j * 2 * n
        print "f", a + i, a + 2 * n + i, a + k
        print "f", a + k, a + 2 * n + i, a + 2 * n + k
      }
      a = last - 2 * n
      print "f", a + i, last, a + k
    }
  }' >"$1.obj"
}

body ball 1 0.6 0.4 0
cat >ball.deck <<'END'
A small body
remesh_surface  surface_size  surface_tolerance  first  ratio  write
yes             0.2           0.01               0.01   1.2    b8.ugrid

farfield
kind    lengths
sphere  3
END

# Within 5 % of the rule: cells, edges on the surface and in the isotropic
# region, first heights, and the even rule's number of layers.
vanguard sweep -q -p ball --family 1:3 -o fam -- --scale-layers even
exits 0
exists fam/family.csv fam/f1-n1-t1/ball.report.json
says out "level"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  NR > 2 {
    n = split("cells surface_edge field_edge first_height layers", name, " ")
    for (i = 1; i <= n; i++) {
      ratio = $at[name[i] "_ratio"]; rule = $at[name[i] "_rule"]
      if (!(ratio > 0.95 * rule && ratio < 1.05 * rule)) {
        print "level", $2, name[i], ratio, "and not", rule; bad = 1
      }
    }
  }
  END { exit bad || NR != 4 }' fam/family.csv >wrong ||
  fail "$(cat wrong) $(cat fam/family.csv)"

vanguard sweep -q -p ball --family 1:2 -o never -- --scale 2
exits 1
says err "give the scale of the first level in the deck"

# The deck's own scale applies to the first level, and its table may name the
# levels.
{
  sed 's/remesh_surface/scale remesh_surface/; s/^yes /2 yes /' ball.deck
  printf '\nsweep\nfamily\n1\n'
} >coarse.deck
vanguard sweep -q -p ball --deck coarse.deck -o coarse
exits 0
says coarse/f1-n1-t1/run.log "scale_layers: first heights are multiplied by 2"
says coarse/family.csv "f1-n1-t1,1,1,"

# The resolved deck gives the same bytes.
vanguard mesh -q -p ball --scale 1.5 --scale-layers workshop --out a
exits 0
vanguard mesh -q -p ball.obj --deck a/ball.resolved.deck --out b
exits 0
same a/ball.b8.ugrid b/ball.b8.ugrid

# A surface that is not remeshed is reported, and so are settings without
# effect.
vanguard mesh -q -p ball --remesh-surface no --layers no --scale 0.8 \
  --cad-angle 10 --coarsening 2 --out c
exits 0
says out "scale 0.8 changes only sizes in the volume"
says out "settings that have no effect because the surface was not remeshed (remesh_surface): surface_tolerance, surface_size"
says out "settings that have no effect because no CAD file was read: cad_angle"
says out "settings that have no effect because no layers grow: first, ratio"
says out "settings that have no effect because the domain was cut by planes (decompose): coarsening"
lacks out "no farfield was made"
vanguard mesh -q -p ball --scale-layers even --out d
says out "setting that has no effect because scale is 1: scale_layers"

# Two neighbouring bodies: edges across the gap.
body pair 1 0.6 0.4 0
n=$(grep -c '^v ' pair.obj)
body other 1 0.6 0.4 2.05
awk -v n="$n" '$1 == "f" { print "f", $2 + n, $3 + n, $4 + n; next } 1' \
  other.obj >>pair.obj
vanguard surface -q pair.obj --surface-size 0.2 --gap-edges 4 \
  --surface-tolerance 0.01 --out gap
exits 0
says out "note: gap_edges 4: limits edge lengths at "
says out "the narrowest gap is 0.05"
vanguard surface -q pair.obj --surface-size 0.2 --surface-tolerance 0.01 \
  --out plain
exits 0
count() { sed -n 's/.*"triangles": \([0-9]*\).*/\1/p' "$1" | head -1; }
vanguard check --json gap/pair.lb8.ugrid
fine=$(count out)
vanguard check --json plain/pair.lb8.ugrid
[ "$fine" -gt "$(count out)" ] || fail "gap_edges made no finer surface"
vanguard mesh -q -p pair.obj --deck ball.deck --layers no --gap-edges 4 -t 2 \
  --out two
exits 0
vanguard mesh -q -p pair.obj --deck two/pair.resolved.deck -t 1 --out again
exits 0
same two/pair.b8.ugrid again/pair.b8.ugrid
vanguard surface -q ball.obj --gap-edges 4 --out none
exits 0
says out "setting that has no effect because no gap is narrow enough: gap_edges"
