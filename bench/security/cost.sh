#!/bin/sh
# Measures what keys cost: sites and subscribers on one host, each case in an open and in a closed world, in turn: `bench/security/cost.sh
# [BUILD] [SECONDS of each] [ROUNDS]`. Keeps the figures with machine and date in bench/results/, and renews the table of
# docs/measurements/security.md. Configure BUILD with -DATRIUM_BENCH=ON. Needs no rights. The machine should be idle.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-15}
rounds=${3:-3}
cmake --build "$build" --target stream_scale keys > /dev/null
cost=$(result security-cost.csv)
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
"$build"/bin/replayed_site --stream "$work/person" --code true > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }

# the keys of all programs, of the world that they are in without keys
keys() { "$build"/bin/keys "$@" --keys "$work/atrium.keys" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }; }
keys init atrium
for i in 0 1 2 3; do keys add site "site-$i"; keys export "site-$i" -o "$work/site-$i.bundle"; done
for i in $(seq 0 15); do keys add viewer "viewer-$i"; keys export "viewer-$i" -o "$work/viewer-$i.bundle"; done

{
    echo "$(heading), $(nproc) cores"
    "$build"/bin/stream_scale head
} > "$cost"
# case SITES SUBSCRIBERS
case_of() {
    "$build"/bin/stream_scale open loopback "$work/person" "$1" "$2" false "$seconds" >> "$cost"
    "$build"/bin/stream_scale closed loopback "$work/person" "$1" "$2" false "$seconds" "$work" >> "$cost"
}
for round in $(seq "$rounds"); do
    echo "round $round of $rounds" >&2
    case_of 1 1
    case_of 1 4
    case_of 4 1
    case_of 4 16
done
python3 bench/security/tables.py cost "$cost" docs/measurements/security.md
