# The test of includes can fail.
check="$here/architecture.sh"
mkdir -p good/src/base good/src/core
echo '#include "base/x.h"' >good/src/core/x.c
touch good/src/base/x.h
"$check" good >out 2>err; status=$?
exits 0

cp -r good upward
echo '#include "core/x.h"' >upward/src/base/x.c
touch upward/src/core/x.h
"$check" upward >out 2>err; status=$?
exits 1
says out "src/base/x.c:1: base must not include core"

cp -r good bare
echo '#include "x.h"' >bare/src/core/x.c
"$check" bare >out 2>err; status=$?
exits 1
says out "does not name its folder"

cp -r good foreign
echo '#include <tetgen.h>' >foreign/src/core/x.c
"$check" foreign >out 2>err; status=$?
exits 1
says out "includes <tetgen.h>"
