#!/bin/sh
# Counts phantoms and lost limbs in 1,080 metaframes of two simulated people: `bench/hull/geometry_people.sh [BUILD]`. Keeps the figures of
# every motion with machine and date in bench/results/ and renews the table of docs/measurements/hull.md. Configure BUILD with
# -DATRIUM_BENCH=ON. Needs no display. Takes about 15 minutes on two cores.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target geometry_people machine_score > /dev/null
table=$(result geometry-people.csv)
parts=$(mktemp -d)
trap 'rm -rf "$parts"' EXIT
heading > "$table"
for look in ada ben; do  # of the first person; the second has the next look
    "$build"/bin/geometry_people --look "$look" > "$parts/$look" &
done
wait
cat "$parts/ada" >> "$table"
tail -n +2 "$parts/ben" >> "$table"
python3 bench/hull/geometry_motion.py people "$table" docs/measurements/hull.md
echo "kept in $table"
