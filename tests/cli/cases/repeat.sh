# SPDX-License-Identifier: LGPL-3.0-or-later
# The same command three times in a folder gives the same mesh and the same
# notes: files left there by a run are not read, which one more note reports.
needs tetgen
octahedron >octa.obj
vanguard surface -q octa.obj --surface-size 0.8 --out s \
  --write stl,tri,obj,mesh,meshb,msh,ugrid,lb8.ugrid,b4.ugrid,r8.ugrid
exits 0
corpus=$here/../fuzz/corpus
gzip -c s/octa.stl >s/octa.stl.gz
{
  head -1 s/octa.tri
  n=$(head -1 s/octa.tri)
  set -- $n
  sed -n "2,$((1 + $1))p" s/octa.tri
  sed -n "$((2 + $1)),$((1 + $1 + $2))p" s/octa.tri | sed 's/$/ 1 0 0/'
} | awk 'NR == 1 { print $2, 0, $1; n = $1; next } { print }' >s/octa.surf

# repeat NAME ARGUMENT FILE...: mesh ARGUMENT three times in the folder NAME.
repeat() {
  name=$1; what=$2; shift 2
  mkdir "$name" || return
  cp "$@" "$name"
  for turn in 1 2 3; do
    vanguard mesh -q -p "$name/$what" --report-html no
    exits 0
    grep '^ *note:' out | grep -vF 'written by an earlier run' >"notes.$turn"
    sed -n 's/.*"xxh3": "\(.*\)".*/\1/p' "$name"/*.report.json |
      sort >"digests.$turn"
    [ -s "digests.$turn" ] || fail "$name: no digests"
    same notes.1 "notes.$turn"
    same digests.1 "digests.$turn"
    [ "$turn" = 1 ] && lacks out "written by an earlier run"
    [ "$turn" != 1 ] && says out "note: $name/${what%%.*}.mapbc was written by \
an earlier run of Vanguard and was not read; --mapbc \
$name/${what%%.*}.mapbc uses it"
  done
}

for suffix in stl stl.gz tri obj mesh meshb msh ugrid lb8.ugrid b4.ugrid \
              r8.ugrid surf; do
  repeat "$suffix.full" "octa.$suffix" "s/octa.$suffix"
  repeat "$suffix.stem" octa "s/octa.$suffix"
done
repeat cgns blocks.cgns "$corpus/cgns/blocks.cgns"
repeat d3m t1 "$corpus/d3m/t1.d3m"
repeat front t1 "$corpus/front/t1.front" "$corpus/d3m/t1.d3m"

# Conditions that a user gave are read each time, and are not changed.
mkdir given
cp s/octa.stl given
printf '1\n1 4000 skin\n' >given/octa.mapbc
vanguard mesh -q -p given/octa --farfield none --report-html no
exits 0
says out "no layers grow on 1 viscous wall (patch 1)"
says out "1 patches have other names in the .mapbc"
lacks out "earlier run"
[ "$(cat given/octa.mapbc)" = "$(printf '1\n1 4000 skin')" ] ||
  fail "given/octa.mapbc was overwritten"

# A file that is named explicitly is read, even if Vanguard wrote it; it must
# exist.
vanguard mesh -q -p stl.full/octa.stl --mapbc stl.full/octa.mapbc \
  --report-html no
exits 0
lacks out "earlier run"
says out "note: stl.full/octa.mapbc lists 1 patches that the surface does not"
says stl.full/octa.resolved.deck "mapbc"
vanguard mesh -q -p s/octa.stl --mapbc given/octa.mapbc --out o \
  --report-html no
exits 0
says out "no layers grow on 1 viscous wall (patch 1)"
vanguard mesh -q -p s/octa.stl --mapbc none.mapbc --out o
exits 1
says err "none.mapbc: cannot open"
vanguard check stl.full/octa.stl
exits 0
says out "was written by an earlier run of Vanguard and was not read"

# The conditions next to a mesh file are read: they belong to its patches.
vanguard check stl.full/octa.b8.ugrid
exits 0
lacks out "earlier run"
says out "farfield"
