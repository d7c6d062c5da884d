# SPDX-License-Identifier: LGPL-3.0-or-later
# The tour of CONTRIBUTING.md names functions that exist in the files it
# gives.
root=$here/../..
n=0
while IFS='|' read -r _ name file _; do
  name=${name//[ \`]/} file=${file//[ \`]/}
  grep -qE "^[a-z].*\\b$name\\(" "$root/src/$file" ||
    fail "no function $name in src/$file"
  n=$((n + 1))
done < <(grep -E '^\| `[a-z_]+` \| `[a-z/_]+\.c`' "$root/CONTRIBUTING.md")
[ "$n" -ge 10 ] || fail "only $n steps in the tour"

# The constants of docs/design/decisions.md are in the files it gives, and name their
# rows.
n=0
while IFS='|' read -r _ row _ file _; do
  row=${row// /} file=${file//[ \`]/}
  grep -qE "(/\* |, |\()$row[ :)]" "$root/src/$file" "$root/$file" \
    2>/dev/null ||
    fail "src/$file does not name row $row of docs/design/decisions.md"
  n=$((n + 1))
done < <(grep -E '^\| [A-Z][0-9]+ \|[^|]*\| `' "$root/docs/design/decisions.md")
[ "$n" -ge 60 ] || fail "only $n constants in docs/design/decisions.md"
