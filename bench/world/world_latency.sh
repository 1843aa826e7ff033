#!/bin/sh
# Measures the time from a hand's capture to the motion of the object that it pushes: `bench/world/world_latency.sh [BUILD] [SECONDS of each
# case]`. Keeps the figures with machine and date in bench/results/ and renews the table of docs/measurements/world.md. Configure BUILD with
# -DATRIUM_BENCH=ON. Needs no rights. Takes about eight minutes. The machine should be idle. RUN is put before each measurement (RUN="nice
# -n -5"). The first run renders the rooms.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-90}
run=${RUN:-}
cmake --build "$build" --target world_latency > /dev/null
out=$(result world-latency.csv)
{
    echo "$(heading), $(nproc) cores, $(c++ --version | head -n 1), ${seconds} s each"
    "$build"/bin/world_latency head
    $run "$build"/bin/world_latency "a simulated room, 8 cameras of 640x480" deploy/rigs/full_body.toml 1 "$seconds"
    $run "$build"/bin/world_latency "two such rooms" deploy/rigs/full_body.toml 2 "$seconds" 20
    $run "$build"/bin/world_latency "two such rooms" deploy/rigs/full_body.toml 2 "$seconds"
    $run "$build"/bin/world_latency "made-up meshes, 16 ms after their capture" meshes 1 "$seconds"
    $run "$build"/bin/world_latency "two such made-up sites" meshes 2 "$seconds"
} > "$out"
python3 bench/world/world_latency.py "$out" docs/measurements/world.md
echo "kept in $out"
