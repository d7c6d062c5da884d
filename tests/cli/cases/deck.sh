# SPDX-License-Identifier: LGPL-3.0-or-later
# The deck that is written can be read, and holds the patches of a surface.
vanguard deck
exits 0
cp out all.deck
says all.deck "Run deck"
for name in scale growth hmin hmax surface_sizes d3m_sources weld repair \
  optimise max_cells write lengths; do
  says all.deck "# $name"
done
says all.deck "# Table farfield"
says all.deck "[length, default 0]"

vanguard demo box --cells 2000
exits 0
vanguard deck box -o new.deck
exits 0
says new.deck "Run deck of box"
grep -qx '6   3   zmax' new.deck || says new.deck "6   "
[ "$(sed -n '/^patches/,/^$/p' new.deck | wc -l)" = 9 ] ||
  fail "not 6 rows of patches"

vanguard deck box -o new.deck
exits 1
says err "new.deck exists and is not overwritten"

# A deck as written changes nothing.
vanguard mesh -q -p box --deck new.deck --out one
exits 0
vanguard mesh -q -p box --deck all.deck --out two
exits 0
same one/box.b8.ugrid two/box.b8.ugrid

# A typing error is reported with its line, and nothing is made.
sed 's/^scale /scael /' all.deck >slip.deck
vanguard mesh -q -p box --deck slip.deck --out three
exits 1
says err "unknown name 'scael' in this deck; did you mean 'scale'?"
says err "slip.deck:$(grep -n '^scael' slip.deck | cut -d: -f1): "
absent three
for name in farfield_lengths farfield.lengths; do
  printf 'a typing error\n\n%s\n20\n' $name >slip.deck
  vanguard mesh -q -p box --deck slip.deck --out three
  exits 1
  says err "did you mean the column lengths of the table farfield?"
done
absent three
vanguard mesh -q -p box --deck missing.deck
exits 1
says err "missing.deck"

# The deck of a demo contains what differs from the defaults, and no more.
vanguard demo wing-half --cells 3000 --out d
exits 0
says d/wing-half.deck "hmax"
says d/wing-half.deck "y_plus"
says d/wing-half.deck "All other settings have their defaults"
lacks d/wing-half.deck "growth"
lacks d/wing-half.deck "leaf_cells"
[ "$(wc -l <d/wing-half.deck)" -lt 30 ] ||
  fail "the deck has $(wc -l <d/wing-half.deck) lines"
