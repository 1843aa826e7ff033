#!/bin/sh
# Draws docs/figures/hull_1_cones.svg to hull_6_fields.svg and hull_meshes.png from real data, and writes their person to
# deploy/views/person.json: `bench/hull/hull_figures.sh [BUILD]`. Configure BUILD with -DATRIUM_BENCH=ON. The same tree gives the same
# pictures.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target hull_charts hull_picture > /dev/null
"$build"/bin/hull_charts | python3 bench/hull/hull_figures.py docs/figures
mkdir -p deploy/views
"$build"/bin/hull_charts views > deploy/views/person.json
"$build"/bin/hull_picture docs/figures/hull_meshes.png
