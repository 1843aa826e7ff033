#!/bin/sh
# Compares drawn people with the pictures of cameras: `bench/viewer/texture_quality.sh [BUILD] [PICTURES]`. Keeps the figures of every
# picture with machine and date in bench/results/ and renews the tables of docs/measurements/viewer.md. Configure BUILD with
# -DATRIUM_BENCH=ON. Needs no display. Writes truth and renderings side by side into the folder PICTURES, if given. Skips missing
# recordings. Takes about two minutes.
set -eu
. "$(dirname "$0")/../common.sh"
pictures=${2:-}
cmake --build "$build" --target texture_quality > /dev/null
table=$(result texture-quality.csv)
{
    echo "$(heading)"
    "$build"/bin/texture_quality ${pictures:+--pictures "$pictures"}
} > "$table"
python3 bench/viewer/texture_quality.py "$table" docs/measurements/viewer.md
echo "kept in $table"
