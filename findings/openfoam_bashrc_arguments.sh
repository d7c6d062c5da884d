#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# OpenFOAM 1912 (Debian openfoam 1912.200626-1+b1): etc/bashrc in a script.
#
# `. etc/bashrc` without arguments gets the arguments of the script that contains
# this line, as every sourced file does. OpenFOAM's bashrc takes its arguments for
# settings: it evaluates NAME=VALUE, and sources those that are files. In a script
# that has arguments of its own, these become settings. In a function that is
# called without arguments, bashrc gets none.
#
# Output seen:
#   plain:    mesh.txt was sourced, WM_LABEL_SIZE 64
#   function: mesh.txt was not sourced, WM_LABEL_SIZE 32
. "$(dirname "$(realpath "$0")")/install.sh"
install openfoam=1912.200626-1+b1
work

echo 'sourced="was sourced"' > mesh.txt
cat > plain.sh <<'S'
sourced="was not sourced"
. /usr/share/openfoam/etc/bashrc 2>/dev/null
echo "$1 $sourced, WM_LABEL_SIZE $WM_LABEL_SIZE"
S
cat > function.sh <<'S'
sourced="was not sourced"
foam() { . /usr/share/openfoam/etc/bashrc 2>/dev/null; }
foam
echo "$1 $sourced, WM_LABEL_SIZE $WM_LABEL_SIZE"
S
run() {
  env -i PATH="$PATH" HOME="$HOME" bash "$1.sh" mesh.txt WM_LABEL_SIZE=64
}
plain=$(run plain) function=$(run function)
echo "plain:    $plain"
echo "function: $function"
[ "$plain" = "mesh.txt was sourced, WM_LABEL_SIZE 64" ] || changed "$plain"
[ "$function" = "mesh.txt was not sourced, WM_LABEL_SIZE 32" ] ||
  changed "$function"
