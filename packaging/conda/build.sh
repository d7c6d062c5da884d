#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Run by rattler-build in the top folder of the sources.
set -euo pipefail
cmake -S . -B build/conda -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_INSTALL_PREFIX="$PREFIX" -DCMAKE_PREFIX_PATH="$PREFIX" \
  -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_TESTING=OFF -DVG_CAD=ON -DVG_PORTAL=ON
cmake --build build/conda
cmake --install build/conda
"${PYTHON:-python}" -m pip install . --no-deps --no-build-isolation
