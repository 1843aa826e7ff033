#!/bin/sh
# Runs two people among the objects of every world of deploy/worlds: `bench/world_endurance.sh [BUILD [MINUTES]]`, 10 simulated minutes of
# each world. Keeps the table with machine and date in bench/results/ and renews the table of docs/measurements/world.md. Fails if a bound was
# broken. Takes about 15 minutes of one core. Progress goes to stderr.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
minutes=${2:-10}
cmake --build "$build" --target world_endurance > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
table="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-world-endurance.csv"
mkdir -p bench/results
status=0
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(bench/score.sh "$build"), $(c++ --version | head -n 1)"
    "$build"/bin/world_endurance "$minutes" || status=$?
} > "$table"
python3 bench/world_endurance.py "$table" docs/measurements/world.md
echo "kept in $table"
exit "$status"
