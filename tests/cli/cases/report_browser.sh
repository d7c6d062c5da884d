# SPDX-License-Identifier: LGPL-3.0-or-later
# PROJECT.report.html in a browser: with scripts the surface rotates, without
# them all pictures are present. Needs Debian's chromium.
browser=$(command -v chromium) || skip "no chromium"

# look OUT ARGS...: the browser, without network, in a separate folder.
look() {
  local to=$1 profile
  shift
  profile=$(mktemp -d)
  timeout 120 "$browser" --headless --no-sandbox --disable-gpu --disable-quic \
    --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --hide-scrollbars \
    --enable-unsafe-swiftshader --virtual-time-budget=20000 \
    --user-data-dir="$profile" "$@" >"$to" 2>browser.log
  status=$?
  rm -rf "$profile"
}

vanguard demo wing-half --cells 20000 --out p
vanguard mesh -q -p p/wing-half --write b8.ugrid --out o
exits 0
page=file://$PWD/o/wing-half.report.html

look blank.html --dump-dom about:blank
[ "$status" = 0 ] || skip "chromium does not start here: $(tail -1 browser.log)"

# With scripts: the 3-D view is drawn, with its controls and instructions.
look dom.html --window-size=1200,900 --dump-dom "$page"
exits 0
drawn=$(sed -n 's/.*data-drawn="\([0-9]*\)".*/\1/p' dom.html)
[ "${drawn:-0}" -gt 20000 ] || fail "the view has ${drawn:-no} pixels"
says dom.html 'Drag to rotate'
[ "$(grep -o 'type="radio"' dom.html | wc -l)" = 4 ] || fail "not 4 choices of colours"
[ "$(grep -o 'type="checkbox"' dom.html | wc -l)" -ge 8 ] || fail "fewer than 8 check boxes"
! grep -q 'Uncaught\|SyntaxError\|Refused to' browser.log ||
  fail "the browser complains: $(grep 'Uncaught\|Refused' browser.log)"

# Without scripts, as the page's policy can demand: the 3-D view stays hidden,
# and the page is a picture that is not blank (a blank one packs to a few
# kilobytes).
sed "s/script-src [^\"]*/script-src 'none'/" o/wing-half.report.html >still.html
look still.dom --dump-dom "file://$PWD/still.html"
says still.dom '<div id="view" hidden="">'
lacks still.dom 'data-drawn='
says still.dom 'Without scripts or WebGL this view is'
look /dev/null --window-size=1200,6000 --screenshot="$PWD/page.png" \
  "file://$PWD/still.html"
exits 0
[ "$(wc -c <page.png)" -gt 300000 ] || fail "the page is blank"
look /dev/null --window-size=500,6000 --screenshot="$PWD/narrow.png" "$page"
[ "$(wc -c <narrow.png)" -gt 100000 ] || fail "the narrow page is blank"

# The summary of a run with nothing to be flagged: each label is on one line.
vanguard demo box --cells 2000 --out p
vanguard mesh -q -p p/box --write b8.ugrid --out o
exits 0
sed 's/<meta http-equiv="Content-Security-Policy"[^>]*>//
  s|</body>|<script>for (const label of document.querySelectorAll(".first b")) {\
  const range = document.createRange(); range.selectNodeContents(label);\
  label.dataset.lines = range.getClientRects().length; }</script></body>|' \
  o/box.report.html >label.html
for width in 1200 800 500; do
  look label.dom --window-size=$width,900 --dump-dom "file://$PWD/label.html"
  says label.dom '<b data-lines="1">As requested</b>'
done
