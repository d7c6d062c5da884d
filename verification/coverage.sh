#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/coverage.sh: the share of the lines or branches of each module that
# the tests execute, from the counts of gcov in a build of the preset `coverage`:
#   cmake --preset coverage -G Ninja && cmake --build --preset coverage
#   ctest --preset coverage; verification/coverage.sh
#
# usage: verification/coverage.sh [--build DIR] [--files] [--branches] [--missed]
#          [--least N] [MODULE...]
#   --build     the build (default build/coverage)
#   --files     a row for each file too
#   --branches  branches instead of lines: the outcomes of conditions, as gcov
#               counts them, but those on lines with assert() or VG_CHECK(, which
#               the tests never see fail, and those of exceptions
#   --missed    with --branches: the lines of branches that no test takes
#   --least     fail if a module of core, layers, partition or io has less than N
#               per cent (default 0)
#   MODULE      names or patterns: 'core/*' (default: all)
# Only C and C++ sources count, not headers. Counts accumulate over runs of the
# tests: delete the .gcda files of the build to reset them.
# Exit status: 0 done, 1 a module has less than N, 2 usage.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
build=$root/build/coverage files='' branches='' missed='' least=0
take_options "build least" "files branches missed" "$@"
[ -d "$build/src" ] || die "no build $build: see --help"
build=$(realpath "$build")
objects=$build/src
source=$(sed -n 's/^vanguard_SOURCE_DIR:STATIC=//p' "$build/CMakeCache.txt")
need gcov gcc
what=lines
[ -z "$branches" ] || what=branches

# "FILE LINES RUN" for every source of src. gcov lists the sources of an object
# file: its own source, and headers.
counts() {
  find "$objects" -name '*.gcno' -print0 |
    (cd "$objects" && xargs -0r -n 1 gcov -n 2>/dev/null) |
    awk -v root="$source/src/" '
      /^File / { file = substr($0, 7, length($0) - 7)
        is_own = index(file, root) == 1 && file ~ /\.(c|cpp)$/ }
      /^Lines executed:/ && is_own { split($2, share, /[:%]/)
        print substr(file, length(root) + 1), $4,
          int(share[2] * $4 / 100 + 0.5); is_own = 0 }' | sort
}

# Some unit tests compile sources again, with calls that fail.
# "FILE BRANCHES TAKEN" for every source of src, or "FILE LINE" for --missed.
branch_counts() {
  find "$build" -ignore_readdir_race -path '*/src/*' -name '*.gcno' -print0 |
    (cd "$objects" && xargs -0r -n 8 gcov -b -c -j -t 2>/dev/null) |
    python3 "$root/verification/branches.py" "$source" ${missed:+--missed}
}

if [ -n "$missed" ]; then
  branch_counts | while read -r file line text; do
    ! wanted "${file%/*}" || echo "$file:$line: $text"
  done
  exit 0
fi
${branches:+branch_}counts | while read -r file count; do
  ! wanted "${file%/*}" || echo "$file $count"
done | awk -v files="$files" -v least="$least" -v what="$what" '
  function row(name, lines, run) {
    printf "| %s | %d | %d | %.1f |\n", name, lines, run, 100 * run / lines
  }
  function flush() {
    if (!lines) return
    row(module, lines, run)
    if (files) printf "%s", below
    if (module ~ /^(core|layers|partition|io)\// && 100 * run < least * lines)
      bad = bad " " module
    all += lines; all_run += run; lines = run = 0; below = ""
  }
  BEGIN { print "| module | " what " | run | % |\n|---|---|---|---|" }
  { at = $1; sub(/\/[^\/]*$/, "", at)
    if (at != module) { flush(); module = at }
    lines += $2; run += $3
    below = below sprintf("| `%s` | %d | %d | %.1f |\n", $1, $2, $3,
      100 * $3 / $2) }
  END { flush()
    if (all) row("all", all, all_run)
    if (bad) { print "below " least " %:" bad; exit 1 } }'
