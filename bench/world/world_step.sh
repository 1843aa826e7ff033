#!/bin/sh
# Measures the steps of a world: `bench/world/world_step.sh [BUILD]`. Keeps the table with machine and date in bench/results/ and renews
# table and curves of docs/measurements/world.md. Configure BUILD with -DATRIUM_BENCH=ON, preferably as a release build. The machine should
# be idle. Takes two to three minutes and shows its progress on the terminal.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target world_step > /dev/null
table=$(result world-step.csv)
{
    echo "$(heading), CPU time of one thread, $(c++ --version | head -n 1)"
    "$build"/bin/world_step
} > "$table"
python3 bench/world/world_step.py "$table" docs/measurements/world.md docs/figures/world_step.svg
echo "kept in $table"
