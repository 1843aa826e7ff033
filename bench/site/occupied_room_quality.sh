#!/bin/sh
# Measures rooms learned from pictures with people in them: `bench/site/occupied_room_quality.sh [BUILD]`. Keeps the table with machine
# and date in bench/results/. docs/backgrounds.md shows it. Configure BUILD with -DATRIUM_BENCH=ON. Skips missing recordings.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target occupied_room_quality > /dev/null
table=$(result occupied-room.csv)
{
    echo "$(heading), one thread, $(c++ --version | head -n 1)"
    "$build"/bin/occupied_room_quality ../shared/data/recordings deploy/rigs/full_body.toml
} > "$table"
echo "kept in $table"
