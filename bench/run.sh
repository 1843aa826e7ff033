#!/bin/sh
# Runs every benchmark of BUILD and keeps the output, with machine and date, in bench/results/.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
mkdir -p bench/results
out="bench/results/$(date +%Y-%m-%d)-$(lscpu | sed -n 's/^Model name: *//p' | tr -c 'A-Za-z0-9\n' '-').txt"
{
    echo "date: $(date -u +%Y-%m-%dT%H:%MZ)"
    echo "machine: $(lscpu | sed -n 's/^Model name: *//p'), $(nproc) cores, $(bench/score.sh "$build")"
    echo "compiler: $(c++ --version | head -n 1), flags: as built in $build"
    for bench in "$build"/bin/*_bench; do
        echo
        echo "== $(basename "$bench")"
        "$bench" --benchmark_repetitions=5 --benchmark_report_aggregates_only=true --benchmark_display_aggregates_only=true
    done
} 2>&1 | tee "$out"
echo "kept in $out"
bench/hull/hull_curves.sh "$build"
bench/site/site_8x1mp.sh "$build"
