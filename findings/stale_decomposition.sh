#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# OpenFOAM 1912 (Debian 1912.200626-1+b1): renumberMesh and decomposePar.
#
# The method "manual" of decomposePar reads the processor of each cell from
# constant/cellDecomposition. `renumberMesh -overwrite` changes the order of the
# cells, but neither this file nor its time stamp is compared with the mesh:
# decomposePar accepts the list of the old order and scatters the processors.
#
# Output seen, 20 x 20 x 20 cells in 4 slabs:
#   before renumberMesh: Number of processor faces = 1200
#   after:               Number of processor faces = 10806
. "$(dirname "$(realpath "$0")")/install.sh"
install openfoam=1912.200626-1+b1
work
openfoam

block 0 1 20
{ foam_head dictionary decomposeParDict
  echo 'numberOfSubdomains 4; method manual;'
  echo 'manualCoeffs { dataFile "cellDecomposition"; }'
} > system/decomposeParDict
{ foam_head labelList cellDecomposition
  echo 8000 '('
  awk 'BEGIN { for (i = 0; i < 8000; i++) print int(i % 20 / 5) }'
  echo ')'; } > constant/cellDecomposition
faces() {
  decomposePar -force > log.decomposePar 2>&1 || changed "decomposePar refuses"
  sed -n 's/^Number of processor faces = //p' log.decomposePar
}
before=$(faces)
rm -rf processor*
renumberMesh -overwrite > log.renumberMesh 2>&1
after=$(faces)
grep -qi warning log.decomposePar && changed "decomposePar warns"
echo "before renumberMesh: Number of processor faces = $before"
echo "after:               Number of processor faces = $after"
[ "$before" = 1200 ] && [ "$after" -gt 5000 ] || changed "$before, $after"
