# SPDX-License-Identifier: LGPL-3.0-or-later
# The program without the library that reads CAD, and without Open CASCADE: the
# message says what to install.
library=$(dirname "$program")/../lib/libvanguard-cad.so.0
[ -e "$library" ] || skip "built without Open CASCADE"
unset LD_LIBRARY_PATH
step=$here/../cad/wing.step
mkdir -p bare/bin bare/lib
cp "$program" bare/bin/
readelf -d bare/bin/vanguard | grep -q 'R.*PATH.*ORIGIN/\.\./lib' ||
  skip "this program searches the library in the build folder"

# refused TEXT...: the copy refuses to read CAD and says this.
refused() {
  local text
  for command in check mesh surface; do
    bare/bin/vanguard $command -q "$step" >out 2>err
    status=$?
    exits 1
    for text; do says err "$text"; done
  done
}
if ldconfig -p | grep -q libvanguard-cad; then
  skip "libvanguard-cad is installed on this system"
fi
refused "wing.step: CAD files need libvanguard-cad.so.0, which was not found" \
  "install libvanguard-cad0"

# The remedy works.
cp "$library" bare/lib/
bare/bin/vanguard check -q "$step" --remesh-surface no >out 2>err
status=$?
exits 0

# Without one of the libraries of Open CASCADE. The copy looks for a name that
# does not exist.
sed 's/libTKXDESTEP/libTKXDEstep/g' "$library" >bare/lib/libvanguard-cad.so.0
refused "wing.step: CAD files need Open CASCADE, which was not found" \
  "libTKXDEstep.so" "install libocct-data-exchange-"

# Another file of this name.
cp "$step" bare/lib/libvanguard-cad.so.0
refused "libvanguard-cad.so.0, which cannot be loaded" \
  "install libvanguard-cad0 again"
