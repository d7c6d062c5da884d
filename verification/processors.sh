#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/processors.sh: the same files on different processors, with
# different BLAS libraries and compilers, in separate runs and in one run.
#
# usage: verification/processors.sh [--quick] [--data DIR] [--vanguard PROGRAM]
#          [--others "PROGRAM..."] [--work DIR] [--out FILE] [CASE...]
#   --quick     60,000 cells, no aircraft
#   --data      folder of real geometry (verification/fetch.md), for aircraft
#   --vanguard  the program (default build/release/bin/vanguard)
#   --others    programs from other builds of the same source, such as clang's,
#               or one with -DCMAKE_C_FLAGS=-DVG_PORTABLE, which has no variants
#               for AVX2 (base/wide.h)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --out       write the table to FILE too (markdown)
#   CASE        box wing dlr_f6_coarse
#
# Other processors are emulated by the libraries that select code by processor:
# the kernels of OpenBLAS (OPENBLAS_CORETYPE, if Debian's libopenblas0-pthread
# is installed) and of the C library (GLIBC_TUNABLES, without AVX2 and FMA).
# Each variant runs alone, and as the second of two ranks, together with the
# unmodified program. The two ranks act as separate nodes and make surface,
# layers and sizes independently. Requirement: one digest per case. Finally,
# ranks with different data must be refused.
# Exit status: 0 all equal, 1 a difference or failure, 2 usage, 77 no mpirun.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
vanguard=$root/build/release/bin/vanguard
work='' data='' quick=0 others='' project='' options=()
take_options "vanguard data others work out" quick "$@"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
command -v mpirun > /dev/null || skip "no mpirun"
work_folder processors
[ -z "$out" ] || : > "$out"
failed=0 size=600000
[ "$quick" = 0 ] || { size=60000; data=''; }
blas=$(dirname "$(ls /usr/lib/*/openblas-pthread/liblapack.so.3 2> /dev/null |
  head -1)")

# Variants: a name, and the words before the options of mesh.
names=() commands=()
variant() { names+=("$1"); commands+=("${*:2}"); }
if [ -n "$blas" ] && [ "$blas" != . ]; then
  for core in Haswell Prescott; do
    variant "OpenBLAS $core" env "LD_LIBRARY_PATH=$blas" \
      "OPENBLAS_CORETYPE=$core" "$vanguard"
  done
fi
variant "C library without AVX2, FMA" env \
  GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-FMA_Usable,-FMA,-FMA4 \
  "$vanguard"
for program in $others; do variant "$program" "$program"; done

# made COMMAND...: digest of the mesh that COMMAND makes for the case.
made() {
  rm -rf "$work/files"
  "$@" -q -p "$project" "${options[@]}" --out "$work/files" \
    > "$work/log" 2>&1 < /dev/null || { echo "failed: $(tail -1 "$work/log")"
                                        return; }
  digest "$work/files"
}

# pair A... -- B...: one run of two nodes, which must have the same helpers.
pair() {
  local a=() mesh
  while [ "$1" != -- ]; do a+=("$1"); shift; done
  shift
  mesh=(mesh -q -p "$project" "${options[@]}" --out "$work/files"
    --test-node-ranks 1)
  rm -rf "$work/files"
  VANGUARD_HELPERS=$(dirname "$vanguard") mpirun --oversubscribe \
    --bind-to none -n 1 "${a[@]}" "${mesh[@]}" : -n 1 "$@" "${mesh[@]}" \
    > "$work/log" 2>&1 < /dev/null ||
    { echo "failed: $(grep -m 1 vanguard: "$work/log")"; return; }
  digest "$work/files"
}

row() {   # row WHAT ALONE PAIR
  local bad=''
  [ "$2" = "$first" ] && [ "$3" = "$first" ] || { bad=DIFFERS; failed=1; }
  echo "| $name | $1 | $2 | $3 | $bad |" | say
}

echo "| case | variant | alone | with the unmodified program | |" | say
echo "|---|---|---|---|---|" | say
for name in box wing dlr_f6_coarse; do
  wanted $name || continue
  case $name in
    box) demo_project box $size "$work/input" ;;
    wing) demo_project wing $((size < 250000 ? 250000 : size)) "$work/input"
          [ "$quick" = 0 ] || options+=(--layer-count 10) ;;
    *) [ -n "$data" ] && aircraft "$data" $name "$work/input" || continue ;;
  esac
  options+=(--leaf-cells 40000)
  first=$(made "$vanguard" mesh)
  row "as it is" "$first" "$(pair "$vanguard" -- "$vanguard")"
  for ((v = 0; v < ${#names[@]}; v++)); do
    read -ra command <<< "${commands[v]}"
    row "${names[v]}" "$(made "${command[@]}" mesh)" \
      "$(pair "$vanguard" -- "${command[@]}")"
  done
done

for what in surface layers sizes; do
  options+=(--test-differ $what)
  got=$(pair "$vanguard" -- "$vanguard")
  [[ $got == *"rank 1 on "*" computed different $what than rank 0 on "* ]] &&
    [ -z "$(ls -A "$work/files" 2> /dev/null)" ] ||
    { echo "other $what: not refused: $got"; failed=1; }
done
exit $failed
