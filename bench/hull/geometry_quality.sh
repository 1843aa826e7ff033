#!/bin/sh
# Compares the shapes of simulated people with their true bodies: `bench/hull/geometry_quality.sh [BUILD]`. Keeps the figures of every
# instant with machine and date in bench/results/ and renews the table of docs/measurements/hull.md. Configure BUILD with -DATRIUM_BENCH=ON.
# Needs no display. Takes about five minutes.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target geometry_quality machine_score > /dev/null
table=$(result geometry-quality.csv)
{
    heading
    "$build"/bin/geometry_quality
} > "$table"
python3 bench/hull/geometry_quality.py "$table" docs/measurements/hull.md
echo "kept in $table"
