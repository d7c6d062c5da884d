# SPDX-License-Identifier: LGPL-3.0-or-later
# PROJECT.report.html: its contents; it loads nothing; names cannot break it;
# it depends on the input alone, except for the section about the run.
needs mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none

# stable FILE: everything except the section about the run and the list of
# files.
stable() { sed '/^<!--run-->$/,/^<!--\/run-->$/d' "$1"; }

vanguard demo box --cells 20000 --out p
layers="--walls 5 --first 0.002 --ratio 1.3 --cells mixed"
run="-q -p p/box --leaf-cells 4000 --write b8.ugrid"
# shellcheck disable=SC2086 # lists of options
{
vanguard mesh $run $layers -t 1 --out one
exits 0
page=one/box.report.html
exists $page
for id in first turn surface cuts layers quality worst solvers settings patches \
  partition run; do
  says $page "<section id=\"$id\""
done
says $page "valid mesh"
says $page "prisms"
says $page "<code>first</code></th><td>0.002 length"
says one/box.report.json '"pictures": '
says one/box.report.json 'box.report.html"'

# Pictures: patches, levels and causes twice, cuts, angles, subdomains; each
# is a PNG in the page with a text for readers who cannot see it.
n=$(grep -o '<img [^>]*src="data:image/png;base64,iVBOR' $page | wc -l)
[ "$n" -ge 13 ] || fail "$n pictures"
[ "$(grep -c '<img ' $page)" = "$(grep -c '<img [^>]* alt="[A-Z]' $page)" ] ||
  fail "a picture has no text"
[ "$(wc -c <$page)" -lt 6000000 ] || fail "$page is large"

# Nothing is loaded: no address except that of SVG.
says $page "default-src 'none'"
! grep -qE '(src|href)="?(https?:)?//' $page || fail "the page loads something"
! grep -qE '@import|url\(' $page || fail "the style loads something"

# Elements are closed: the numbers of start and end tags are equal.
for element in section table tr figure svg div ul details script style; do
  begins=$(grep -oE "<$element[ >]" $page | wc -l)
  ends=$(grep -o "</$element>" $page | wc -l)
  [ "$begins" = "$ends" ] || fail "<$element>: $begins begin, $ends end"
done

# The same page for any number of threads and ranks, and after a resume.
stable $page >one.html
vanguard mesh $run $layers -t 3 --out threads
stable threads/box.report.html >threads.html
same one.html threads.html
vanguard mesh $run $layers --run-dir kept --keep-run --out first
vanguard mesh $run $layers --run-dir kept --resume --out resumed
exits 0
stable resumed/box.report.html >resumed.html
same one.html resumed.html
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 3 "$program" mesh $run $layers -t 1 \
    --out ranks >out 2>err
  status=$?
  exits 0
  stable ranks/box.report.html >ranks.html
  same one.html ranks.html
else
  echo "no mpirun that starts here: threads only"
fi

# Switched off.
vanguard mesh $run --report-html no --out without
exits 0
absent without/box.report.html
lacks without/box.report.json "report.html"

# A limit that is not met is shown at the top.
cp p/box.deck own.deck
printf '\nlayers\nid grow first min_full\n5 yes 3e-2 99\n6 yes - -\n' >>own.deck
vanguard mesh $run --deck own.deck --first 2e-2 --layer-count 80 --ratio 1.2 \
  --out limit
exits 4
says limit/box.report.html '<span class="badge bad">1 limit on the layers not'
says limit/box.report.html '<li class="bad"><b>Not met</b> <span>Patch 5 '
}

# Names that look like markup stay text, in the page and in its data.
{
  echo '</title><script>alert(1)</script> & "x"'
  printf '\npatches\nid  bc  name\n5   4   "</script><img src=x onerror=a()>"\n'
} >p/bad.deck
vanguard mesh -q -p p/box --deck p/bad.deck --write b8.ugrid --out bad
if [ "$status" = 0 ]; then
  lacks bad/box.report.html '<script>alert'
  lacks bad/box.report.html '<img src=x'
  says bad/box.report.html '&lt;/title&gt;'
  [ "$(grep -o '</script>' bad/box.report.html | wc -l)" = 4 ] ||
    fail "a name ends a script"
else
  fail "the deck is refused"
fi
