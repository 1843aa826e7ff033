#!/bin/sh
# Compares drawn people with the pictures of cameras: `bench/texture_quality.sh [BUILD] [PICTURES]`. Keeps the figures of every picture with
# machine and date in bench/results/ and renews the tables of docs/measurements/viewer.md. Configure BUILD with -DATRIUM_BENCH=ON. Needs no display.
# Writes truth and renderings side by side into the folder PICTURES, if given. Skips missing recordings. Takes about two minutes.
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
