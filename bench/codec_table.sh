#!/bin/sh
# Measures the coded size of a frame: `bench/codec_table.sh [BUILD]`. Keeps the table with machine and date in bench/results/ and renews the
# table of docs/measurements/codecs.md. Configure BUILD with -DATRIUM_BENCH=ON. The machine should be idle. Skips the recording if ../shared/data is
# missing.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
cmake --build "$build" --target codec_table > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
table="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-codec.csv"
mkdir -p bench/results
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), one thread, $(c++ --version | head -n 1)"
    "$build"/bin/codec_table
} > "$table"
python3 bench/codec_table.py "$table" docs/measurements/codecs.md
echo "kept in $table"
