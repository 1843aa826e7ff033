#!/bin/sh
# Runs two people among the objects of every world of deploy/worlds: `bench/world/world_endurance.sh [BUILD [MINUTES]]`, 10 simulated
# minutes of each world. Keeps the table with machine and date in bench/results/ and renews the table of docs/measurements/world.md. Fails
# if a bound was broken. Takes about 15 minutes of one core. Progress goes to stderr.
set -eu
. "$(dirname "$0")/../common.sh"
minutes=${2:-10}
cmake --build "$build" --target world_endurance > /dev/null
table=$(result world-endurance.csv)
status=0
{
    echo "$(heading), $(c++ --version | head -n 1)"
    "$build"/bin/world_endurance "$minutes" || status=$?
} > "$table"
python3 bench/world/world_endurance.py "$table" docs/measurements/world.md
echo "kept in $table"
exit "$status"
