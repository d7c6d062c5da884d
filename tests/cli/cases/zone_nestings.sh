# SPDX-License-Identifier: LGPL-3.0-or-later
# Zones drawn at random: inside each other, touching, ending at walls, thin.
needs tetgen

seeds="1 2 3 4 5 6"
[ -z "${VG_LONG:-}" ] || seeds=$(seq 60)
for seed in $seeds; do
  python3 "$here/zone_lattice.py" "$seed" "z$seed" || fail "seed $seed"
  set -- mesh "z$seed.stl" --flow internal --zone-interfaces 'i_*' --walls '*' \
    --layer-count 2 --first 0.001 --cells mixed --quiet --write b8.ugrid
  vanguard "$@" --threads 1 --out one
  exits 0
  awk '/^  Coverage/ { n = 1 } /^  Total height/ { n = 0 }
    n && $2 ~ /^w[1-6]$/ && $4 < 99 { print $2, $4 }' out >thin
  [ ! -s thin ] || fail "seed $seed: layers $(cat thin)"
  vanguard "$@" --threads 3 --decompose octree --leaf-cells 3000 --out three
  exits 0
  for run in one three; do
    vanguard check "$run/z$seed.b8.ugrid"
    exits 0
    says out "validity: valid"
    says out "difference 0"
    awk '/^ *zone kind/ { n = 1; next }
      n && NF < 5 { exit } n { print $4 }' out | sort -g |
      paste - "z$seed.volumes" >both
    awk 'NF != 2 || ($1 - $2) ^ 2 > (1e-4 * $2) ^ 2 { bad = 1 }
      END { exit bad || !NR }' both || fail "seed $seed: volumes $(cat both)"
  done
  vanguard "$@" --threads 2 --out two
  exits 0
  same "one/z$seed.b8.ugrid" "two/z$seed.b8.ugrid"
  same "one/z$seed.sheets" "two/z$seed.sheets"
done
