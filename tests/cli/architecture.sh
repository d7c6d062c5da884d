#!/bin/bash
# Includes go one way: base <- core <- layers <- partition <- cli and core <-
# io <- cli.
# Fails on an include against the arrows, without a folder, or of a
# third-party header outside the file that adapts it.
# architecture.sh SOURCE_ROOT
set -u
cd "$1/src" || exit 1
bad=0

declare -A rank=([base]=0 [core]=1 [layers]=2 [io]=3 [partition]=3
  [cli]=4)

complain() {
  echo "$*"
  bad=1
}

for folder in *; do
  [ -n "${rank[$folder]:-}" ] ||
    complain "src/$folder: a folder without a place in the order"
done

while IFS=: read -r file line text; do
  target=${text#*\"}
  target=${target%%\"*}
  from=${file%%/*}
  to=${target%%/*}
  if [ "$to" = "$target" ]; then
    complain "src/$file:$line: \"$target\" does not name its folder"
  elif [ ! -e "$target" ]; then
    complain "src/$file:$line: \"$target\" does not exist"
  elif [ "${rank[$to]:-9}" -gt "${rank[$from]:-9}" ]; then
    complain "src/$file:$line: $from must not include $to ($target)"
  elif [ "$from" = io ] && [[ $to = layers || $to = partition ]]; then
    complain "src/$file:$line: io knows the types of core only ($target)"
  fi
done < <(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' \
  --include='*.[ch]' --include='*.cpp' .  | sed 's,^\./,,')

# Third-party headers and the files that may see them.
adapter() {
  local header=$1 allowed=$2 file
  while IFS= read -r file; do
    [[ $file =~ $allowed ]] || complain "src/$file includes <$header>"
  done < <(grep -rlE "#[[:space:]]*include[[:space:]]*[<\"]${header}[>\"]" . |
    sed 's,^\./,,')
}
adapter tetgen.h '^core/cdt_tetgen\.cpp$'
adapter zlib.h '^io/[a-z_]+\.c$'
adapter jansson.h '^cli/'
adapter argp.h '^cli/'
adapter lapacke.h '^layers/gram\.c$'
adapter pthread.h '^(base|partition)/'
adapter mpi.h '^(base/comm(_[a-z]+)?\.c|base/comm_parts\.h|io/shared_file\.c)$'
adapter hwloc.h '^base/comm_cores\.c$'
adapter xxhash.h '^partition/store[a-z_]*\.c$'

[ "$bad" = 0 ] && echo "all includes follow the arrows"
exit $bad
