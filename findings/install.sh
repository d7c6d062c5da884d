# shellcheck shell=bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Sourced by the scripts of this folder: `install PACKAGE=VERSION...` installs
# Debian packages as root, and `work` changes to a temporary folder.
set -euo pipefail
export LC_ALL=C DEBIAN_FRONTEND=noninteractive

install() {
  local package missing=()
  for package; do
    [ "$(dpkg-query -W -f '${Version}' "${package%%=*}" 2>/dev/null || :)" = \
      "${package#*=}" ] || missing+=("$package")
  done
  [ ${#missing[@]} != 0 ] || return 0
  apt-get -qq update
  apt-get -qq -o DPkg::Lock::Timeout=600 install -y --no-install-recommends \
    --allow-downgrades "${missing[@]}" >/dev/null
}

work() {
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  cd "$folder"
}

# The environment of Debian's OpenFOAM; its script prints warnings.
openfoam() {
  set +eu
  # shellcheck disable=SC1091
  . /usr/share/openfoam/etc/bashrc 2>/dev/null
  set -eu
}

changed() {
  echo "CHANGED: $*"
  exit 1
}

# foam_head CLASS OBJECT: head of an OpenFOAM file.
foam_head() {
  printf 'FoamFile { version 2.0; format ascii; class %s; object %s; }\n' "$@"
}

# control: the dictionaries that OpenFOAM's mesh tools require.
control() {
  mkdir -p system constant
  { foam_head dictionary controlDict
    echo 'startFrom startTime; startTime 0; stopAt endTime; endTime 1;'
    echo 'deltaT 1; writeControl timeStep; writeInterval 1;'
    echo 'writeFormat ascii; writePrecision 16;'; } > system/controlDict
  { foam_head dictionary fvSchemes
    echo 'ddtSchemes {} gradSchemes {} divSchemes {} laplacianSchemes {}'
    echo 'interpolationSchemes {} snGradSchemes {}'; } > system/fvSchemes
  foam_head dictionary fvSolution > system/fvSolution
}

# block X0 X1 N: blockMesh of the box [X0, X1] x [0, 1]^2, N cells per side.
block() {
  control
  { foam_head dictionary blockMeshDict
    echo 'scale 1; vertices ('
    for z in 0 1; do
      echo "($1 0 $z) ($2 0 $z) ($2 1 $z) ($1 1 $z)"
    done
    echo "); blocks ( hex (0 1 2 3 4 5 6 7) ($3 $3 $3) simpleGrading (1 1 1) );"
    echo 'edges (); boundary (); mergePatchPairs ();'; } > system/blockMeshDict
  blockMesh > log.blockMesh
}
