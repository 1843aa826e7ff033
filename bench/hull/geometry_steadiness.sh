#!/bin/sh
# Measures how much the shapes of simulated people flicker from metaframe to metaframe: `bench/hull/geometry_steadiness.sh [BUILD]`. Keeps
# the figures of every motion with machine and date in bench/results/ and renews the table of docs/measurements/hull.md. Configure BUILD
# with -DATRIUM_BENCH=ON. Needs no display. Takes about five minutes.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target geometry_steadiness machine_score > /dev/null
table=$(result geometry-steadiness.csv)
{
    heading
    "$build"/bin/geometry_steadiness
} > "$table"
python3 bench/hull/geometry_motion.py steadiness "$table" docs/measurements/hull.md
echo "kept in $table"
