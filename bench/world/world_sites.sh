#!/bin/sh
# Measures sites on one host with a world server and one viewer: `bench/world/world_sites.sh [BUILD] [SECONDS of each case]`. The sites are
# simulated: each replays the coded frames of the simulated room at 30 Hz. Measures whether steps are on time (skipped ticks), dropped
# meshes, capture to collision (median and p99), and the share of a core of each program. Keeps the figures with machine and commit in
# bench/results/ and renews the table of docs/measurements/world.md. Configure BUILD with -DATRIUM_BENCH=ON. Needs no rights. Takes about
# two minutes. The machine should be idle. SITES="1 4" chooses the numbers of sites, STREAM=FILE keeps the coded frames from run to run, RUN
# is put before each program (RUN="nice -n -5").
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-20}
cmake --build "$build" --target replayed_site world_server viewer monitor > /dev/null
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
stream=${STREAM:-$work/person}
[ -e "$stream" ] || "$build"/bin/replayed_site --stream "$stream" --code true > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
out=$(result world-sites.csv)
{
    echo "$(heading), $(nproc) cores, $(c++ --version | head -n 1), ${seconds} s each"
    python3 bench/world/world_sites.py measure "$build" "$stream" "$seconds" ${SITES:-1 2 4}
} > "$work/table"
mv "$work/table" "$out"
python3 bench/world/world_sites.py table "$out" docs/measurements/world.md
echo "kept in $out"
