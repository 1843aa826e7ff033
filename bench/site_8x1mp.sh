#!/bin/sh
# Measures the whole site on two cores: `bench/site_8x1mp.sh [BUILD] [SECONDS of each case]`. Keeps text and table with machine and
# date in bench/results/ and renews the table of docs/measurements/site.md. Configure BUILD with -DATRIUM_BENCH=ON.
# The machine should be idle. The first run renders the pictures.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
seconds=${2:-8}
cmake --build "$build" --target site_8x1mp > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
out="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-site-8x1mp"
mkdir -p bench/results
comment="# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), $(nproc) cores, $(c++ --version | head -n 1), niceness $(nice), ${seconds} s each"
echo "$comment" > "$out.csv"
{ echo "$comment"; "$build"/bin/site_8x1mp "$seconds" "$out.csv"; } | tee "$out.txt"
python3 bench/site_8x1mp.py "$out.csv" docs/measurements/site.md
echo "kept in $out.csv and $out.txt"
