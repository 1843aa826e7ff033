#!/bin/sh
# How people look beside what cameras saw: `bench/texture_quality.sh [BUILD] [PICTURES]`. Keeps every picture's figures with machine and
# date in bench/results/ and renews the tables of docs/measurements/viewer.md. BUILD has to be configured with -DATRIUM_BENCH=ON; it needs no display.
# With a folder PICTURES, truth and renderings go there side by side. Recordings that are not here are left out. About two minutes.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
pictures=${2:-}
cmake --build "$build" --target texture_quality > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
table="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-texture-quality.csv"
mkdir -p bench/results
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build")"
    "$build"/bin/texture_quality ${pictures:+--pictures "$pictures"}
} > "$table"
python3 bench/texture_quality.py "$table" docs/measurements/viewer.md
echo "kept in $table"
