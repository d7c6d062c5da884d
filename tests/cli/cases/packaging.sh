# SPDX-License-Identifier: LGPL-3.0-or-later
# The recipes have the version of the program, and build all of its parts.
top=$here/../..
recipe=$top/packaging/conda/recipe.yaml
package=$top/packaging/spack/packages/vanguard/package.py
vanguard --version
version=$(sed -n 's/^vanguard //p' out)
says "$recipe" "version: \"$version\""
says "$package" "version(\"$version\", tag=\"v$version\")"
says "$top/CITATION.cff" "version: $version"

# Every part of the build that is an option is a variant of Spack. The conda
# package switches no part off, and requires the libraries of all parts.
grep -rhoE 'vg_part\((VG_[A-Z0-9]+)' "$top/CMakeLists.txt" "$top/src" \
  "$top/cmake" "$top/helpers" --include=CMakeLists.txt --include='*.cmake' |
  sed 's/.*(VG_//' | tr '[:upper:]' '[:lower:]' | sort -u >parts
[ -s parts ] || fail "no parts found"
grep -oE 'variant\("[a-z0-9]+"' "$package" | sed 's/.*("//; s/"//' |
  sort -u >variants
diff parts variants || fail "variants of Spack"
! grep -E -- '-DVG_[A-Z]+=OFF' "$top/packaging/conda/build.sh" ||
  fail "conda lacks a part"
for name in occt libmicrohttpd hdf5 metis tetgen cgal-cpp; do
  says "$recipe" "- $name"
done

# Spack finds the repository from the place of the recipe.
command -v python3 >/dev/null || skip "no python3"
python3 - "$package" >out 2>err <<'END'
import sys, types
spack = types.ModuleType("spack.package")
spack.CMakePackage = type("CMakePackage", (), {})
for name in "license version variant depends_on".split():
    setattr(spack, name, lambda *a, **k: None)
spack.__all__ = [n for n in dir(spack) if not n.startswith("_")]
sys.modules["spack"] = types.ModuleType("spack")
sys.modules["spack.package"] = spack
path = sys.argv[1]
scope = {"__file__": path, "__name__": "package"}
exec(compile(open(path).read(), path, "exec"), scope)
print(scope["Vanguard"].git)
END
status=$?
exits 0
is out <<<"file://$(realpath "$top")"
