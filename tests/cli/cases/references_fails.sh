# SPDX-License-Identifier: LGPL-3.0-or-later
# The test of references to documents can fail, for each of its reasons.
command -v python3 >/dev/null || skip "no python3"
mkdir -p good/src/core/mesh good/docs/reference good/docs/design
touch good/src/core/mesh/mesh.h
cat >good/docs/reference/formats.md <<'END'
# Formats
See [the layout](#12-layout) and [decisions](../design/decisions.md#kernel), row K1.
## 1.2 Layout
END
cat >good/docs/design/decisions.md <<'END'
# Decisions
## Kernel
| K1 | 0.5 | `a.c` |
| K2 | 0.7 | `a.c` |
END
cat >good/src/a.c <<'END'
/* Records (formats.md 1.2), as docs/reference/formats.md, "Layout", says: formats.md
 * 1.2. Rows K1 and K2 have the constants. */
#define A 0.5   /* K1: of the size */
/* core/mesh/mesh.h has the mesh. Of T1 nothing is said. ONERA M6 is a wing (K2). */
END

# refused NAME TEXT FILE LINE: the good tree with LINE appended to FILE fails
# for this reason.
refused() {
  cp -r good "$1"
  echo "$4" >>"$1/$3"
  python3 "$here/references.py" "$1" >out 2>err; status=$?
  exits 1
  says out "$2"
}

python3 "$here/references.py" good >out 2>err; status=$?
exits 0

refused file "src/a.c: notes.md does not exist" src/a.c "/* notes.md 3 */"
refused section "docs/reference/formats.md has no section 1.3" src/a.c \
  "/* formats.md 1.3. */"
refused second "docs/reference/formats.md has no section 7" src/a.c \
  "/* formats.md 1.2 and 7: both */"
refused broken "docs/reference/formats.md has no section 9.1" src/a.c \
  "$(printf '/* As formats.md\n * 9.1 has it. */')"
refused title 'docs/reference/formats.md has no heading "Order"' src/a.c \
  '/* docs/reference/formats.md, "Order". */'
refused tag "docs/design/decisions.md has no row K3" src/a.c "#define B 3  /* K3 */"
refused list "docs/design/decisions.md has no row K4" src/a.c "/* K1, K4: both */"
refused brackets "docs/design/decisions.md has no row K5" src/a.c "/* Here (K5). */"
refused row "docs/design/decisions.md has no row K6" docs/reference/formats.md "Rows K1 to K6."
refused twice "row K2 occurs twice" docs/design/decisions.md '| K2 | 1 | `b.c` |'
refused source "src/core/mesh/m.h does not exist" src/a.c \
  "/* core/mesh/m.h has it. */"
refused bare "there is no source file mash.h" docs/design/decisions.md \
  'The header `mash.h` has it.'
mkdir -p good/src/io/mesh && touch good/src/io/mesh/mesh.h
refused folder "mesh.h is in src/core/mesh, src/io/mesh: name the folder" \
  docs/design/decisions.md 'The header `mesh.h` has it.'
refused link "the link to x.md leads nowhere" docs/reference/formats.md "[x](x.md)"
refused anchor "docs/design/decisions.md has no heading for #zones" docs/reference/formats.md \
  "[x](../design/decisions.md#zones)"
