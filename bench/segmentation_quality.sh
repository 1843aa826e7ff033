#!/bin/sh
# Measures the masks beside OpenCV's: `bench/segmentation_quality.sh [BUILD]`. Keeps the table with machine and date in
# bench/results/ and renews that of docs/measurements/segmentation.md. Configure BUILD with -DATRIUM_BENCH=ON. The machine
# should have nothing else to do. Recordings are left out where ../shared/data is not there.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
cmake --build "$build" --target segmentation_quality > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
table="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-segmentation.csv"
mkdir -p bench/results
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), one thread, $(c++ --version | head -n 1)"
    "$build"/bin/segmentation_quality
} > "$table"
python3 bench/segmentation_table.py "$table" docs/measurements/segmentation.md
echo "kept in $table"
