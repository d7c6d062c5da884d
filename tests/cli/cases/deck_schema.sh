# SPDX-License-Identifier: LGPL-3.0-or-later
# The JSON Schema of decks agrees with the program: every deck of the examples,
# of the demonstrations and of the other tests is valid, and of random documents
# the program accepts exactly those that are valid. VG_LONG: more of them.
command -v python3 >/dev/null || skip "python3 is not installed"
for name in $("$program" demo --list | awk '{ print $1 }'); do
  vanguard demo "$name" --cells 3000 --out demo
done
n=150
[ "${VG_LONG:-0}" = 0 ] || n=5000
# Texts that other tests write to files: those of three lines or more that the
# program reads as decks. With them, the corpus of the fuzzer.
python3 - "$here" <<'END'
import glob, re, sys
for path in glob.glob(sys.argv[1] + "/cases/*.sh"):
    for i, (word, text) in enumerate(re.findall(
            r"<<'?(\w+)'?\n(.*?)^\1$",
            open(path).read(), re.M | re.S)):
        if text.count("\n") > 2:
            name = "%s%d.tested" % (re.sub(r".*/", "", path), i)
            open(name, "w").write(text)
END
tested=
for deck in *.tested "$here"/../fuzz/corpus/deck/*; do
  # Decks with errors on purpose are left out; most have none.
  ! "$program" deck --deck "$deck" >/dev/null 2>&1 || tested="$tested $deck"
done
[ "$(echo "$tested" | wc -w)" -ge 5 ] || fail "few decks of tests: $tested"
# shellcheck disable=SC2046,SC2086 # lists of files
python3 "$here/deck_schema.py" "$program" $n 1 $tested demo/*.deck \
  $(find "$here/../../examples" "$here/../../verification" -name '*.deck') \
  >out 2>err
status=$?
[ $status != 77 ] || skip "python3-jsonschema is not installed"
exits 0

# Conversion both ways keeps every setting.
cat >text.deck <<'END'
A wing, half model
growth  first  walls        write
1.15    1e-05  "3-12,""a b"",c"  b8.ugrid,vtu

sources
kind    x0   h0    group
sphere  0.1  0.02  "the tip"

layers
id     grow  ratio
3      yes   1.25
flap*  no    -
END
vanguard deck --deck text.deck --json
exits 0
cp out first.json
vanguard deck --deck first.json -o second.deck
exits 0
vanguard deck --deck second.deck --json
exits 0
same first.json out
says out '"growth": 1.15,'
vanguard deck --deck text.deck -o second.deck
exits 1
says err "second.deck exists and is not overwritten"

# A JSON deck of a run, and refusals with the place and a remedy.
vanguard demo box --cells 2000 --out p
echo '{"title": "By program", "settings": {"growth": 1.4, "write": "vtu"}}' \
  >by.json
vanguard mesh -q -p p/box --deck by.json --out run
exits 0
exists run/box.vtu
says run/box.resolved.deck "1.4"
absent run/box.b8.ugrid
refused() {
  printf '%s\n' "$1" >bad.json
  vanguard mesh -q -p p/box --deck bad.json --out bad
  exits 1
  is err <<END
vanguard: bad.json:$2
END
  absent bad/box.b8.ugrid
}
refused '{"settings": {"growht": 1.4}}' \
  " settings.growht: unknown name; did you mean 'growth'?"
refused '{"setings": {}}' " setings: unknown name; did you mean 'settings'?"
refused '{"settings": {"growth": "1.4"}}' " settings.growth: must be a number"
refused '{"settings": {"layers": true}}' " settings.layers: must be a string"
refused '{"settings": {"growth": 1}}' \
  " settings.growth: growth is 1; it must be above 1 and at most 10"
refused '{"sources": [{"kind": "point", "h0": 1}, {"kind": "point"}]}' \
  " sources[1]: the member 'h0' is required"
refused '{"patches": [{"id": "12"}]}' " patches[0].id: the number of a patch \
must not be a string; give 12 without quotation marks"
refused '{"settings": {"hmin": 2, "hmax": 1}}' \
  " hmin 2 is larger than hmax 1; swap them or set one to 0"
refused '{"settings": {"growth": 1.4},
 "settings": {}}' "2: not a valid JSON document (a deck that begins with '{' is \
one): duplicate object key near '\"settings\"'"
refused '{"settings"' "2: not a valid JSON document (a deck that begins with '{' \
is one): ':' expected near end of file"

vanguard deck --schema --json
exits 2
vanguard deck p/box --deck text.deck
exits 2
