#!/bin/sh
# Measures a site and a viewer over links with faults: `bench/stream_faults.sh [BUILD] [SECONDS of each case]`. Keeps the figures with
# machine and date in bench/results/ and renews the table of docs/measurements/streams.md. Configure BUILD with -DATRIUM_BENCH=ON. Needs /dev/net/tun,
# but no rights. Takes about five minutes. The machine should be idle.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
seconds=${2:-15}
cmake --build "$build" --target stream_faults > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
out="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-stream-faults.csv"
mkdir -p bench/results
echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), $(nproc) cores, $(c++ --version | head -n 1), ${seconds} s each" > "$out"
"$build"/bin/stream_faults "$seconds" >> "$out"
python3 bench/stream_faults.py "$out" docs/measurements/streams.md
