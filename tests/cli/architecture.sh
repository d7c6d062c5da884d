#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Checks the sources against src/CMakeLists.txt, which lists the modules from
# the bottom up with the modules that each one may include. Fails on
#   - a source folder that is not a module, a module of more than 40 files
#   - a module that includes a module forbidden to its part of the program (io
#     may use only core), or that lists a module it does not need
#   - an include without its folder, of a module that is not listed, or of a
#     private header (NAME_parts.h, or "Private to" in it) of another module
#   - headers that include each other
#   - a third-party header outside the file that adapts it
#   - a struct, union or enum vg_NAME that is defined twice
#   - a file name that two modules have, unless it is listed below
#   - a constant of a hash function outside base/hash.h: a hand-written hash
#     table
#   - a test that tests/README.md does not name
#   - a symbol used from a higher module, if a BUILD folder is given
# architecture.sh SOURCE_ROOT [BUILD]
set -u
build=${2:+$(realpath "$2")}
cd "$1/src" || exit 1
bad=0
MOST_FILES=40

complain() {
  echo "$*"
  bad=1
}

# --- modules ---

declare -A place sees used
modules=()
while read -r module seen; do
  place[$module]=${#modules[@]}
  modules+=("$module")
  sees[$module]=" $seen "
done < <(awk '/^vg_module\(/ { on = 1; line = "" }
  on { line = line " " $0 }
  on && /\)/ { gsub(/vg_module\(|\)/, " ", line); print line; on = 0 }' \
  CMakeLists.txt)

# The parts of the program that each part may use, besides base.
declare -A parts=([base]="" [core]="core" [layers]="core layers"
  [partition]="core layers partition" [io]="core io"
  [run]="core layers partition io run" [api]="core run"
  [cli]="core layers partition io run cli")
for module in "${modules[@]}"; do
  part=${module%%/*}
  for seen in ${sees[$module]}; do
    [[ " base ${parts[$part]-} " = *" ${seen%%/*} "* ]] ||
      complain "src/CMakeLists.txt: $part must not see $seen"
  done
done

while read -r n folder; do
  [ -n "${place[$folder]-}" ] ||
    complain "src/$folder: the folder is not listed in src/CMakeLists.txt"
  [ "$n" -le $MOST_FILES ] ||
    complain "src/$folder: $n files, at most $MOST_FILES in a module"
done < <(find . -mindepth 2 -name '*.[ch]*' -printf '%P\n' |
  grep -v '^cli/main\.c$' | sed 's,/[^/]*$,,' | sort | uniq -c)

# --- includes ---

declare -A is_private
while IFS= read -r file; do
  is_private[$file]=1
done < <({ find . -name '*_parts.h'; grep -rl --include='*.h' 'Private to' .
         } | sed 's,^\./,,' | sort -u)

includes=$(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' \
  --include='*.[ch]' --include='*.cpp' . | sed 's,^\./,,')
while IFS=: read -r file line text; do
  target=${text#*\"}
  target=${target%%\"*}
  from=${file%/*}
  [ "$from" != cli ] || from=cli/commands   # main.c
  to=${target%/*}
  used["$from $to"]=1
  if [ "$to" = "$target" ]; then
    complain "src/$file:$line: \"$target\" does not name its folder"
  elif [ ! -e "$target" ]; then
    complain "src/$file:$line: \"$target\" does not exist"
  elif [ "$from" = "$to" ]; then
    continue
  elif [[ ${sees[$from]-} != *" $to "* ]]; then
    complain "src/$file:$line: $from must not include $to ($target)"
  elif [ -n "${is_private[$target]-}" ]; then
    complain "src/$file:$line: $target is private to its module"
  fi
done <<< "$includes"

for module in "${modules[@]}"; do
  for seen in ${sees[$module]}; do
    [ -n "${used["$module $seen"]-}" ] ||
      complain "src/CMakeLists.txt: $module sees $seen, but includes nothing from it"
  done
done

loop=$(sed -nE 's,^([^:]*\.h):[0-9]*:[^"]*"([^"]*)".*,\1 \2,p' \
  <<< "$includes" | tsort 2>&1 >/dev/null | sed -n 's/^tsort: \([^-]\)/\1/p')
[ -z "$loop" ] || complain "headers include each other:" $loop

# Third-party headers and the files that may include them.
adapter() {
  local header=$1 allowed=$2 file
  while IFS= read -r file; do
    [[ $file =~ $allowed ]] || complain "src/$file includes <$header>"
  done < <(grep -rlE "#[[:space:]]*include[[:space:]]*[<\"]${header}[>\"]" . |
    sed 's,^\./,,')
}
adapter tetgen.h '^$'   # in helpers/tetgen only
adapter '[A-Z][A-Za-z0-9_]*\.hxx' '^io/occt/occt_[a-z]+\.(cpp|h)$'
adapter 'CGAL/[A-Za-z0-9_]*\.h' '^$'   # in helpers/wrap only
adapter zlib.h '^(io/[a-z]+/[a-z_]+|run/picture/image)\.c$'
adapter jansson.h '^(run|cli)/'
adapter argp.h '^cli/'
adapter microhttpd.h '^cli/http/http\.c$'
# The last bits of LAPACK's results differ between processors: never use it
# where a mesh is made.
adapter lapacke.h '^partition/model/rates\.c$'
adapter pthread.h \
  '^(base|partition|core/mesher|layers/relax)/|^run/(common/progress\.c|picture/cuts_parts\.h)$'
adapter mpi.h \
  '^(base/comm(_[a-z]+)?\.c|base/comm_parts\.h|io/stream/shared_file\.c)$'
adapter metis.h '^partition/graph/graph_metis\.c$'
adapter hdf5.h '^io/cgns/cgns_tree\.c$'
adapter hwloc.h '^base/comm_cores\.c$'
adapter xxhash.h '^partition/store/store[a-z_]*\.c$'

# --- names ---

while read -r n tag; do
  [ "$n" = 1 ] || complain "$tag is defined $n times:" $(grep -rlE \
    "\\b$tag \{" --include='*.[ch]' --include='*.cpp' .)
done < <(grep -rhoE '\b(struct|union|enum) (vg|vanguard)_[a-z0-9_]+ \{' \
  --include='*.[ch]' --include='*.cpp' . | sed 's/ {$//' | sort | uniq -c)

# File names that two modules share; the folder distinguishes them.
declare -A shared
for name in assets boundary child domain front gaps input job layers mesh output \
    page patches progress put_back share sizes slices slices_parts text walls work; do
  shared[$name]=1
done
while read -r file; do
  [ -n "${shared[${file%.*}]-}" ] ||
    complain "two files are called $file:" $(find . -name "$file")
done < <(find . -name '*.[ch]*' -printf '%f\n' | sort | uniq -d)

# Constants of hash functions.
while IFS= read -r file; do
  complain "src/$file has a constant of base/hash.h: use base/table.h"
done < <(grep -rliE '0x(9e3779b|c2b2ae3d|165667b1|d6e8feb8)|2654435769' \
  --include='*.[ch]' . | sed 's,^\./,,' |
  grep -v '^base/hash\.h$')

# The README of the tests must list every test in its table.
tests=../tests
table=$tests/README.md
if [ -e $table ]; then
  for file in ../tests/{unit,mpi,cli}/test_*.c ../tests/cli/cases/*.sh \
      ../tests/fuzz/fuzz_*.c; do
    [ -e "$file" ] || continue
    name=${file##*/}
    name=${name#test_} name=${name#fuzz_} name=${name%.*}
    grep -qE "[ .\`]$name[ \`]" $table ||
      complain "${file#../} is missing in tests/README.md"
  done
fi

# --- symbols ---

# Prints "PLACE MODULE SYMBOL KIND" for every symbol of every object file; KIND
# is U if the symbol is only used there.
symbols() {
  local module
  for module in "${modules[@]}"; do
    find "$build/src/CMakeFiles/vg_${module//\//_}.dir" -name '*.o' -print0 \
      2>/dev/null | xargs -0r nm -g 2>/dev/null |
      awk -v module="$module" -v at="${place[$module]}" 'NF >= 2 && $NF ~ /^(vg_|vanguard_)/ {
        print at, module, $NF, $(NF - 1) }'
  done
}
if [ -n "$build" ]; then
  upward=$(symbols | sort -u | awk '$4 != "U" { at[$3] = $1; module[$3] = $2 }
    $4 == "U" { user[++n] = $1; from[n] = $2; what[n] = $3 }
    END {
      for (i = 1; i <= n; i++)
        if (what[i] in at && at[what[i]] + 0 > user[i] + 0)
          print from[i] " uses " what[i] " of " module[what[i]]
    }')
  [ -z "$upward" ] || complain "$upward"
fi

[ "$bad" = 0 ] && echo "all includes follow src/CMakeLists.txt"
exit $bad
