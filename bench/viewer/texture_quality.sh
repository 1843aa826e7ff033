#!/bin/sh
# Compares drawn people with the pictures of cameras: `bench/viewer/texture_quality.sh [BUILD] [PICTURES]`. Keeps the figures of every
# picture with machine and date in bench/results/ and renews the tables of docs/measurements/viewer.md. Configure BUILD with
# -DATRIUM_BENCH=ON. Needs no display. Writes truth and renderings side by side into the folder PICTURES, if given. Skips missing
# recordings. Takes about five minutes.
set -eu
. "$(dirname "$0")/../common.sh"
pictures=${2:-}
cmake --build "$build" --target texture_quality > /dev/null
table=$(result texture-quality.csv)
{
    echo "$(heading)"
    "$build"/bin/texture_quality ${pictures:+--pictures "$pictures"}
    for refine in round photo round_photo; do
        for scene in ring20 room; do
            "$build"/bin/texture_quality ${pictures:+--pictures "$pictures"} --refine $refine --only $scene --orbit-steps 0 | tail -n +2
        done
    done
    for scene in ring20 room; do
        "$build"/bin/texture_quality --soft-outlines false --only $scene --orbit-steps 0 | tail -n +2
    done
} > "$table"
python3 bench/viewer/texture_quality.py "$table" docs/measurements/viewer.md
echo "kept in $table"
