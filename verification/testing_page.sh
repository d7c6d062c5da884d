#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/testing_page.sh: the numbers of docs/reference/testing.md that
# can be counted in the sources.
#
# usage: verification/testing_page.sh [--write]
#   --write  replaces the table in the page; without it, the table is printed
# Exit status: 0 done, 2 usage.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
page=$root/docs/reference/testing.md
cd "$root/tests"

# count FILE...: the files that exist, for patterns.
count() { compgen -G "$1" | wc -l; }

# cases [short]: cases of the injected faults.
cases() {
  awk -v short="${1:-}" 'BEGIN { RS = ""; FS = "\n" }
    { head = ""
      for (i = 1; i <= NF && head == ""; i++) if ($i !~ /^#/) head = $i
      if (head == "" || (short != "" && head !~ / short/)) next
      n += sub(/.* for /, "", head) ? split(head, words, " ") : 1 }
    END { print n + 0 }' faults/cases.txt
}

table() {
  echo "| in the sources | number |"
  echo "|---|---|"
  echo "| unit programs | $(count 'unit/test_*.c') |"
  echo "| MPI programs, each on 1, 2 and 4 ranks | $(count 'mpi/test_*.c') |"
  echo "| cases and programs of the command line |" \
    "$(($(count 'cli/cases/*.sh') + $(count 'cli/test_*.c'))) |"
  echo "| fuzz targets | $(count 'fuzz/fuzz_*.c') |"
  echo "| inputs in their corpora | $(find fuzz/corpus -type f | wc -l) |"
  echo "| cases of injected faults | $(cases) |"
  echo "| of these with every run of the tests | $(cases short) |"
  echo "| public geometries | $(grep -cv '^#' ../verification/success/files.tsv) |"
}

case ${1:-} in
  '') table ;;
  --write)
    text=$(table) awk '/^\| in the sources/ { print ENVIRON["text"]; skip = 1 }
      skip && /^\|/ { next }
      { skip = 0; print }' "$page" >"$page.new"
    mv "$page.new" "$page"
    ;;
  *) echo "usage: verification/testing_page.sh [--write]" >&2; exit 2 ;;
esac
