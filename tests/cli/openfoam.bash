# SPDX-License-Identifier: LGPL-3.0-or-later
# OpenFOAM's environment, for the cases that run its programs.

# In a function without arguments: OpenFOAM's bashrc sources the files that it
# finds among the arguments of its caller, and a case is one.
source_openfoam() {
  # shellcheck disable=SC1090
  . "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" 2>/dev/null
}

# Does nothing if the environment is set. The bashrc uses variables that are
# not set.
load_openfoam() {
  [ -z "${WM_PROJECT_DIR:-}" ] || return 0
  set +u
  source_openfoam
  set -u
}
