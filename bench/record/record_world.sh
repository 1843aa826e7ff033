#!/bin/sh
# Records a world of two simulated sites, a world server and a viewer, and plays it again: the recorder's share of a core, MB per minute,
# whether every sample arrives again with the same bytes, how exact the times are, and how long 100 random jumps take.
# `bench/record/record_world.sh [BUILD] [SECONDS]`, 600 s; takes twice as long. Configure BUILD with -DATRIUM_BENCH=ON.
# Keeps the figures in bench/results/ and renews the table of docs/measurements/recording.md. The machine should be idle.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-600}
cmake --build "$build" --target programs replay_check > /dev/null
exec python3 bench/record/record_world.py --build "$build" --seconds "$seconds" --out "$(result record-world).json"
