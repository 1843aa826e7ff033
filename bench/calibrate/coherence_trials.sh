#!/bin/sh
# Simulated sites that watch their rig: `bench/calibrate/coherence_trials.sh [BUILD [SEEDS [MINUTES]]]`, how soon a camera that was moved is
# named (20 runs of each fault), and whether anybody is blamed in 60 minutes of changing light, with one person and with two. Keeps both tables
# with machine and date in bench/results/ and renews docs/measurements/calibration.md. Configure BUILD with -DATRIUM_BENCH=ON. Takes about
# five minutes.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target coherence_trials > /dev/null
drift=$(result coherence-drift.csv)
{
    heading
    "$build"/bin/coherence_trials drift "${2:-20}"
} > "$drift"
hour=$(result coherence-hour.csv)
{
    heading
    "$build"/bin/coherence_trials hour "${3:-60}"
} > "$hour"
python3 bench/calibrate/coherence_tables.py "$drift" "$hour" docs/measurements/calibration.md
echo "kept in $drift and $hour"
