#!/bin/sh
# Measures a site, a world server and a viewer whose host lacks processor time, on a bridge with and without a limit:
# `bench/stream/stream_starved.sh [BUILD] [SECONDS of each case] [SEEDS]`. Keeps the figures with machine and date in bench/results/ and
# renews the table of docs/measurements/streams.md. BUILD holds bin/site_node, bin/world_server and bin/viewer. Needs root, a control group
# of the processor and two idle cores. Takes about nine hours with 300 s and ten seeds. ONLY="quota:0:lan loops:5:wan" measures only these
# cases: how the viewer is starved, the limit in Mbit/s, the network. BUILT=1: BUILD is up to date.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-60}
seeds=${3:-3}
cases=${ONLY:-none:0:lan quota:0:lan loops:0:lan freezes:0:lan none:20:lan quota:20:lan loops:20:lan none:5:wan quota:5:wan loops:5:wan}
[ -n "${BUILT:-}" ] || cmake --build "$build" --target site_node world_server viewer > /dev/null
out=$(result stream-starved.csv)
cache=${CACHE:-.cache/simulation}
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(nproc) cores, $(c++ --version | head -n 1)"
    python3 bench/stream/starved_run.py head
} > "$out"
for case in $cases; do
    for seed in $(seq "$seeds"); do
        # shellcheck disable=SC2046
        python3 bench/stream/starved_run.py "$build" $(echo "$case" | tr : ' ') "$seconds" "$seed" "$cache" >> "$out"
    done
done
python3 bench/stream/stream_starved.py "$out" docs/measurements/streams.md
