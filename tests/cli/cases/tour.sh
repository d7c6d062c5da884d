# The tour of CONTRIBUTING.md names functions that are where it says.
root=$here/../..
n=0
while IFS='|' read -r _ name file _; do
  name=${name//[ \`]/} file=${file//[ \`]/}
  grep -qE "^[a-z].*\\b$name\\(" "$root/src/$file" ||
    fail "no function $name in src/$file"
  n=$((n + 1))
done < <(grep -E '^\| `[a-z_]+` \| `[a-z/_]+\.c`' "$root/CONTRIBUTING.md")
[ "$n" -ge 10 ] || fail "only $n steps in the tour"
