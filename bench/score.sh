#!/bin/sh
# Prints the machine's score for the first line of a result: `bench/score.sh [BUILD]`. The other scripts here call it.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
build=${1:-build}
cmake --build "$build" --target machine_score > /dev/null
"$build/bin/machine_score" | sed -n 's/^one core  *score *\([0-9.]*\) .*/machine score \1/p'
