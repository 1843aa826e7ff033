#!/bin/sh
# Tries the acts of people with objects of a world, with hulls from the cameras of a simulated room: `bench/world/world_trials.sh [BUILD]
# [TRIALS]`, 20 of each by default. Keeps every trial with machine and date in bench/results/ and renews the table of
# docs/measurements/world.md. Configure BUILD with -DATRIUM_BENCH=ON. The hulls take about 10 minutes the first time and are kept in
# .cache/world_trials.
set -eu
. "$(dirname "$0")/../common.sh"
trials=${2:-20}
cmake --build "$build" --target world_trials > /dev/null
table=$(result world-trials.csv)
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ)"
    "$build"/bin/world_trials --trials "$trials"
} > "$table"
python3 bench/world/world_trials.py "$table" docs/measurements/world.md
echo "kept in $table"
