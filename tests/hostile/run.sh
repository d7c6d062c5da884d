#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Gives every hostile file to the program: run.sh MAKE_HOSTILE PROGRAM FOLDER.
# A refused file: exit status 1, stderr names the file, and the answer
# contains the phrase of its line in CASES. A repaired file: status 0 and the
# phrase. Never a signal, a time-out, or the report of a sanitizer.
set -u
make_hostile=$(realpath "$1")
program=$(realpath "$2")
folder=$3
failures=0
count=0

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder" || exit 1
"$make_hostile" . || exit 1
export LC_ALL=C COLUMNS=80

fail() {
  failures=$((failures + 1))
  echo "FAILED: $command $file: $*"
  echo "--- status $status, out"; head -20 out
  echo "--- err"; head -20 err
}

# Not a number, or nearly 2^64, unless it is quoted from the file.
strange="(^|[^a-zA-Z'(])-?(nan|inf)([^a-zA-Z'._]|\$)|\(-?(nan|inf)[^a-zA-Z)]"
strange="$strange|18446744073709"
unites=1
"$program" --version --verbose | grep -q "vanguard-wrap not found" && unites=0

while IFS='|' read -r command file verdict phrase; do
  count=$((count + 1))
  [ $unites = 1 ] || [ "$phrase" != "were united" ] || verdict=refused
  timeout 60 "$program" $command "$file" >out 2>err </dev/null
  status=$?
  expected=1
  [ "$verdict" = mended ] && expected=0
  [ $status = $expected ] || fail "exit status $status, not $expected"
  grep -qF -- "$phrase" out err ||
    { [ $unites = 0 ] && grep -q "needs vanguard-wrap" err; } ||
    fail "the answer lacks '$phrase'"
  if [ "$verdict" = refused ]; then
    grep -qF -- "${file%.*}" err || fail "stderr does not name the file"
  fi
  ! grep -qE 'Sanitizer|runtime error' out err || fail "a sanitizer reports"
  ! grep -qE "$strange" out err || fail "a number in the answer is wrong"
done <CASES

echo "$count hostile files, $failures failures"
[ $count -ge 40 ] && [ $failures = 0 ]
