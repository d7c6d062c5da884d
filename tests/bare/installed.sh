#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Uses the installed packages as a new user would, in an empty folder: program,
# CAD reader, portal, Python module, manual.
set -euo pipefail
folder=$(mktemp -d)
cd "$folder"

vanguard demo wing --cells 20000 --out demo
vanguard mesh -q -p demo/wing --write b8.ugrid,vtu --out meshed
[ -s meshed/wing.b8.ugrid ]
vanguard check -q meshed/wing.b8.ugrid
vanguard check -q /usr/share/doc/vanguard/examples/wing_from_cad/wing.step

python3 - <<'END'
import vanguard
job = vanguard.Job()
job.open("demo/wing")
job.set(layers="no")
mesh = job.mesh()
print("python3:", vanguard.library_version(), mesh.points.shape)
END

# The portal answers on the port that it names.
vanguard serve --port 0 >serve.log 2>&1 &
portal=$!
python3 - <<'END'
import re
import time
import urllib.request

for i in range(100):
    found = re.search(r"http://\S+", open("serve.log").read())
    if found:
        break
    time.sleep(0.1)
else:
    raise SystemExit(open("serve.log").read())
page = urllib.request.urlopen(found.group(0).rstrip(".,")).read().decode()
assert "<html" in page, page[:200]
print("portal:", len(page), "characters")
END
kill $portal
wait $portal || true
echo "the installed packages work"
