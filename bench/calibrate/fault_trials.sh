#!/bin/sh
# Calibrates simulated rooms from swept wands, boards, and marks on the floor, with and without faults:
# `bench/calibrate/fault_trials.sh [BUILD [SEEDS [GOOD]]]`, 20 runs of each fault and 50 good ones. Tells how often each fault is refused and
# named, how exact boards are with other robust widths, and how long rooms of several sizes take. Keeps the tables with machine and date in
# bench/results/ and renews docs/measurements/calibration.md. Configure BUILD with -DATRIUM_BENCH=ON. Takes about 40 minutes.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target wand_trials board_trials > /dev/null
wands=$(result wand-trials.csv)
{
    heading
    "$build"/bin/wand_trials trials "${2:-20}" "${3:-50}"
} > "$wands"
boards=$(result board-trials.csv)
{
    heading
    "$build"/bin/board_trials "${2:-20}" "${3:-50}"
} > "$boards"
widths=$(result board-widths.csv)
{
    heading
    "$build"/bin/board_trials widths 10
} > "$widths"
times=$(result wand-times.csv)
{
    heading
    "$build"/bin/wand_trials times
} > "$times"
python3 bench/calibrate/fault_tables.py "$wands" "$boards" "$widths" "$times" docs/measurements/calibration.md
echo "kept in $wands, $boards, $widths and $times"
