#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Checks that all sources are laid out as CONTRIBUTING requires. Fails, naming
# the place, on
#   - a C or C++ source that clang-format 14 would change (.clang-format)
#   - a line of more than 80 columns
#   - a function of more than 60 lines, or a file of more than 800, below src
# format.sh SOURCE_ROOT
# format.sh --tidy SOURCE_ROOT BUILD   clang-tidy instead (.clang-tidy), by the
#                                      compile_commands.json of BUILD
# Exit status: 0 yes, 1 no, 77 a program is missing.
set -euo pipefail

program() {
  for name in "$1-14" "$1"; do
    if "$name" --version 2>/dev/null | grep -q 'version 14\.'; then
      echo "$name"
      return
    fi
  done
  echo "SKIP: no $1 14" >&2
  exit 77
}

if [ "$1" = --tidy ]; then
  tidy=$(program clang-tidy)
  cd "$2"
  find src -name '*.c' -print0 | sort -z |
    xargs -0 -n 12 -P "$(nproc)" "$tidy" -p "$3" --quiet 2>/dev/null
  exit
fi

cd "$1"
format=$(program clang-format)
failed=0
complain() {
  echo "$*"
  failed=1
}

sources=$(find src helpers tests bench \( -name '*.[ch]' -o -name '*.cpp' \) \
  -not -path '*/corpus/*' | sort)
while IFS= read -r file; do
  complain "$file: $format -i $file changes it"
done < <(xargs -n 16 -P "$(nproc)" "$format" --dry-run <<<"$sources" 2>&1 |
  sed -n 's/:[0-9]*:[0-9]*: warning: .*//p' | sort -u)
while IFS= read -r place; do
  complain "$place: more than 80 columns"
done < <(awk 'length > 80 { print FILENAME ":" FNR }' $sources)
while IFS= read -r place; do
  complain "$place"
done < <(find src -name '*.[ch]' | sort | xargs awk '
  FNR == 1 { begin = 0 }
  FNR == 801 { print FILENAME ": more than 800 lines" }
  /^\{/ { begin = FNR }
  /^\}/ {
    if (begin && FNR - begin > 61)
      print FILENAME ":" begin ": a function of " FNR - begin - 1 " lines"
    begin = 0
  }')
[ "$failed" = 1 ] || echo "all sources follow .clang-format"
exit "$failed"
