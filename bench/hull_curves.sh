#!/bin/sh
# Measures the hull: `bench/hull_curves.sh [BUILD] [REPETITIONS]`. Keeps tables with machine and date in bench/results/,
# draws docs/figures/hull_curves.svg, prints all tables and renews those of docs/measurements/hull.md. Configure BUILD with -DATRIUM_BENCH=ON.
# The machine should be idle. Skips everything that needs ../shared/data if it is missing.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
repetitions=${2:-20}
cmake --build "$build" --target hull_curves hull_memory > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
prefix="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-hull"
mkdir -p bench/results
comment="# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), $(nproc) cores, $(c++ --version | head -n 1), least of $repetitions"
for table in segments views threads sets masks; do
    echo "measuring: $table"
    { echo "$comment"; "$build"/bin/hull_curves "$table" "$repetitions"; } > "$prefix-$table.csv"
done
{ echo "$comment"; "$build"/bin/hull_memory; } > "$prefix-memory.csv"
python3 bench/hull_curves.py "$prefix" docs/figures/hull_curves.svg docs/measurements/hull.md
echo "kept in $prefix-*.csv"
