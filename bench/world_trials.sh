#!/bin/sh
# Tries the acts of people with objects of a world, with hulls from the cameras of a simulated room: `bench/world_trials.sh [BUILD]
# [TRIALS]`, 20 of each by default. Keeps every trial with machine and date in bench/results/ and renews the table of docs/measurements/world.md.
# Configure BUILD with -DATRIUM_BENCH=ON. The hulls take about 10 minutes the first time and are kept in .cache/world_trials.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
trials=${2:-20}
cmake --build "$build" --target world_trials > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
table="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-world-trials.csv"
mkdir -p bench/results
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ)"
    "$build"/bin/world_trials --trials "$trials"
} > "$table"
python3 bench/world_trials.py "$table" docs/measurements/world.md
echo "kept in $table"
