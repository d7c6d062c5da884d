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

# Every cause of layers/columns/columns.h is explained to users, and known to
# the schema of the report and to the header of the library.
n=0
for key in $(sed -n '/define VG_LAYER_CAUSES/,/^$/s/.*ROW([A-Z_]*, "\([a-z_]*\)".*/\1/p' \
    "$root/src/layers/columns/columns.h"); do
  [ "$key" = none ] || grep -q "^| $key |" "$root/docs/reference/layers.md" ||
    fail "docs/reference/layers.md has no row for the cause $key"
  grep -qF "\"$key\"" "$root/src/api/vanguard.h" ||
    fail "src/api/vanguard.h does not name the cause $key"
  grep -qF "\"$key\": {" "$root/share/schema/report.schema.json" ||
    fail "share/schema/report.schema.json lacks the cause $key"
  n=$((n + 1))
done
[ "$n" -ge 8 ] || fail "only $n causes in layers/columns/columns.h"
