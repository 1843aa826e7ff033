#!/bin/sh
# Measures the steps of a world: `bench/world_step.sh [BUILD]`. Keeps the table with machine and date in bench/results/ and renews table and
# curves of docs/measurements/world.md. Configure BUILD with -DATRIUM_BENCH=ON, preferably as a release build. The machine should be idle. Takes
# two to three minutes and shows its progress on the terminal.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
cmake --build "$build" --target world_step > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
table="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-world-step.csv"
mkdir -p bench/results
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), CPU time of one thread, $(c++ --version | head -n 1)"
    "$build"/bin/world_step
} > "$table"
python3 bench/world_step.py "$table" docs/measurements/world.md docs/figures/world_step.svg
echo "kept in $table"
