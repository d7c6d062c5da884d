# SPDX-License-Identifier: LGPL-3.0-or-later
# Sources that are limited by coarse faces, or that are outside the domain,
# are reported with a remedy; those of the demos are not.
vanguard demo sphere --cells 20000 --out p
exits 0
vanguard mesh -q -p p/sphere --out plain
exits 0
lacks out "source "
says plain/sphere.report.json '"limited": []'
says plain/sphere.report.json '"inside_body": []'
vanguard demo wing --out w
exits 0
vanguard plan -q -p w/wing -n 1
exits 0
lacks out "source "

sed -i '/^sources$/,$d' p/sphere.deck
cat >>p/sphere.deck <<'END'
sources
kind      x0  y0  z0  x1  y1  z1  h0   r0   r1   group
sphere    0   0   0   -   -   -   0.25 1    -    body
cylinder  2   0   0   18  0   0   0.3  0.5  0.5  wake
point     0   17  0   -   -   -   0.1  0.1  -    far
point     0   0   0   -   -   -   0.1  0.1  -    within
point     90  0   0   -   -   -   0.1  0.1  -    away
point     0   0   -12 -   -   -   0.1  0.1  -    below
END
vanguard mesh -q -p p/sphere --out held
exits 0
lacks out "source 1 "
says out "source 2 (cylinder of wake, from 2 0 0) is limited at"
says out "source 3 (point of far, from 0 17 0) is limited everywhere: it requests "
says out "on patch 2 (farfield)"
says out "limit it; make their edges no longer than"
says out "1 source (number 4) lies completely inside a body"
says out "1 source (number 5) lies completely outside the domain"
says held/sphere.report.json '"patch_name": "farfield"'
says held/sphere.report.json '"edge_required": '
grep note out >notes

# All ranks and all threads report the same, and so does plan.
vanguard mesh -q -p p/sphere --out held2 --threads 2
exits 0
grep note out | diff - notes || fail "notes depend on threads"
vanguard plan -q -p p/sphere -n 1
exits 0
says out "source 3 (point of far, from 0 17 0) is limited everywhere"
says out "1 source (number 5) lies completely outside the domain"
vanguard plan -q -p p/sphere -n 1 --json
exits 0
says out '"everywhere": true'
says out '"outside_domain": ['

# The advised remedy works.
growth=$(sed -n 's/.*source 6 .*increase growth to //p' notes)
[ -n "$growth" ] || fail "no growth rate is advised"
vanguard mesh -q -p p/sphere --out grown --growth "$growth"
exits 0
lacks out "source 6 "

# Fast growth no longer misses a small sphere; a point near which cells cannot
# grow that fast is reported.
vanguard demo box --cells 20000 --out b
exits 0
sed -i '/^sources$/,$d' b/box.deck
cat >>b/box.deck <<'END'
sources
kind    x0    y0    z0    h0     r0
sphere  0.313 0.217 0.411 0.002  0.02
END
vanguard mesh -q -p b/box --out ball --growth 4
exits 0
lacks out "source "
says ball/box.report.json '"unresolved": []'
cells=$(sed -n 's/^ *"cells": \([0-9]*\),/\1/p' ball/box.report.json |
        sort -n | tail -n 1)
[ "$cells" -gt 30000 ] || fail "only $cells cells"
cat >>b/box.deck <<'END'
point   0.7   0.6   0.5   0.0005 0
END
vanguard mesh -q -p b/box --out point --growth 4
exits 0
lacks out "source 1 "
says out "source 2 (point) is not resolved at 1 of 1 sample points: at (0.7, 0.6, 0.5)"
says point/box.report.json '"sample_points_unresolved": 1'
