# SPDX-License-Identifier: LGPL-3.0-or-later
# The architecture test can fail, for each of its reasons.
check="$here/architecture.sh"
mkdir -p good/src/base good/src/core/mesh good/src/core/fill
cat >good/src/CMakeLists.txt <<'END'
vg_module(base)
vg_module(core/mesh base)
vg_module(core/fill core/mesh)
END
touch good/src/base/x.h good/src/core/mesh/m_parts.h
echo '#include "base/x.h"' >good/src/core/mesh/m.h
echo '#include "core/mesh/m.h"' >good/src/core/fill/f.c
"$check" good >out 2>err; status=$?
exits 0

# refused NAME TEXT: the modified copy NAME of the good tree fails for this
# reason.
refused() {
  "$check" "$1" >out 2>err; status=$?
  exits 1
  says out "$2"
}

cp -r good upward
echo '#include "core/mesh/m.h"' >upward/src/base/x.c
refused upward "src/base/x.c:1: base must not include core/mesh"

cp -r good unseen
echo '#include "base/x.h"' >>unseen/src/core/fill/f.c
refused unseen "src/core/fill/f.c:2: core/fill must not include base"

cp -r good idle
: >idle/src/core/mesh/m.h
refused idle "core/mesh sees base, but includes nothing from it"

cp -r good private
echo '#include "core/mesh/m_parts.h"' >>private/src/core/fill/f.c
refused private "core/mesh/m_parts.h is private to its module"

cp -r good bare
echo '#include "m.h"' >>bare/src/core/fill/f.c
refused bare "does not name its folder"

cp -r good hash
echo 'int h(int x) { return x * 0x9e3779b1u; }' >>hash/src/core/fill/f.c
refused hash "src/core/fill/f.c has a constant of base/hash.h"

cp -r good foreign
echo '#include <tetgen.h>' >>foreign/src/core/fill/f.c
refused foreign "includes <tetgen.h>"

cp -r good circle
echo '#include "core/mesh/m_parts.h"' >>circle/src/core/mesh/m.h
echo '#include "core/mesh/m.h"' >circle/src/core/mesh/m_parts.h
refused circle "headers include each other"

cp -r good homeless
mkdir homeless/src/core/odd
touch homeless/src/core/odd/o.c
refused homeless "src/core/odd: the folder is not listed in src/CMakeLists.txt"

cp -r good full
for i in $(seq 41); do touch full/src/core/fill/f$i.c; done
refused full "src/core/fill: 42 files, at most 40 in a module"

cp -r good part
cat >>part/src/CMakeLists.txt <<'END'
vg_module(layers/grow core/fill)
vg_module(io/mesh layers/grow)
END
refused part "io must not see layers/grow"

cp -r good untold
mkdir -p untold/tests/unit
touch untold/tests/README.md untold/tests/unit/test_x.c
refused untold "tests/unit/test_x.c is missing in tests/README.md"

cp -r good tag
echo 'struct vg_x { int a; };' >>tag/src/core/mesh/m.h
echo 'struct vg_y { struct vg_x { int b; } c; };' >>tag/src/core/fill/f.c
refused tag "struct vg_x is defined 2 times: "

cp -r good name
echo '#include "base/x.h"' >name/src/core/mesh/x.h
refused name "two files are called x.h: "

# A symbol declared in a lower module and defined in a higher one.
cp -r good symbol
objects=build/src/CMakeFiles
mkdir -p $objects/vg_base.dir $objects/vg_core_mesh.dir
echo 'int vg_above(void); int vg_x(void) { return vg_above(); }' |
  ${CC:-cc} -c -x c - -o $objects/vg_base.dir/x.o
echo 'int vg_above(void) { return 1; }' |
  ${CC:-cc} -c -x c - -o $objects/vg_core_mesh.dir/m.o
"$check" symbol build >out 2>err; status=$?
exits 1
says out "base uses vg_above of core/mesh"
