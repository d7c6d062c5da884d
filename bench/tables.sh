#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/tables.sh: the tables of docs/lab/performance*.md, each by its script.
#
# usage: bench/tables.sh [--write] [--data DIR] [--build DIR] [TABLE...]
#   --write  replace the tables in the pages; without it they are printed
#   --data   folder of real geometry (verification/fetch.md)
#   --build  build folder (default build/release)
#   TABLE    names of tables in the pages, or patterns (default all)
#
# A table lies between the lines "<!-- table NAME: COMMAND -->" and
# "<!-- end of table -->". The command runs in the root of the project, with the
# options --data and --build for {data} and {build}; its output is the table. It
# begins with the version, the commit, the machine and the date. A command that
# fails leaves its table as it is.
# Exit status: 0 done, 1 a command failed, 2 usage, 77 without --data.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
data='' build=$root/build/release write=0
take_options "data build" "write" "$@"
[ -d "$data" ] || skip "no folder of real geometry: give --data DIR (verification/fetch.md)"
work_folder tables

# put PAGE NAME FILE: the lines of FILE between the marks of the table.
put() {
  awk -v mark="<!-- table $2: " -v file="$3" '
    index($0, mark) == 1 {
      print
      while ((getline line < file) > 0) print line
      inside = 1
      next
    }
    $0 == "<!-- end of table -->" { inside = 0 }
    !inside' "$1" >"$work/page"
  cat "$work/page" >"$1"
}

# Lines "PAGE NAME COMMAND" of all tables, with tabs between.
list() {
  local page
  for page in "$root"/docs/lab/performance*.md; do
    sed -n "s|^<!-- table \([a-z0-9-]*\): \(.*\) -->\$|$page\t\1\t\2|p" "$page"
  done
}

status=0 n_table=0
while IFS=$'\t' read -r page name command; do
  wanted "$name" || continue
  n_table=$((n_table + 1))
  command=${command//\{data\}/\"$data\"}
  command=${command//\{build\}/\"$build\"}
  if ! (cd "$root" && bash -c "$command") >"$work/$name" </dev/null; then
    echo "$script: $name: $command failed" >&2
    status=1
  elif [ $write = 1 ]; then
    put "$page" "$name" "$work/$name"
  else
    printf '%s\n\n' "$name"
    cat "$work/$name"
    echo
  fi
done < <(list)
[ $n_table -gt 0 ] || die "no table '${cases[*]}' in docs/lab/performance*.md"
exit $status
