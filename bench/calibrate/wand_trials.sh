#!/bin/sh
# Calibrates simulated rooms from swept wands, with and without faults: `bench/calibrate/wand_trials.sh [BUILD [SEEDS [GOOD]]]`, 20 runs of
# each fault and 50 good ones. Tells how often each fault is refused and named, and how long rooms of several sizes take. Keeps both tables
# with machine and date in bench/results/ and renews docs/measurements/calibration.md. Configure BUILD with -DATRIUM_BENCH=ON. Takes about
# ten minutes.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target wand_trials > /dev/null
trials=$(result wand-trials.csv)
{
    heading
    "$build"/bin/wand_trials trials "${2:-20}" "${3:-50}"
} > "$trials"
times=$(result wand-times.csv)
{
    heading
    "$build"/bin/wand_trials times
} > "$times"
python3 bench/calibrate/wand_trials.py "$trials" "$times" docs/measurements/calibration.md
echo "kept in $trials and $times"
