#!/bin/sh
# Measures libraries beside pieces of Atrium that do the same work: `bench/libraries/libraries.sh [BUILD]`. Keeps the table with machine and
# date in bench/results/ and renews the table of docs/design/dependencies.md. Configure BUILD with -DATRIUM_BENCH=ON. The machine should be
# idle. Skips libyuv if it is not installed.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target library_times > /dev/null
table=$(result libraries.csv)
{
    echo "$(heading), one thread, $(c++ --version | head -n 1)"
    "$build"/bin/library_times
} > "$table"
python3 bench/libraries/libraries.py "$table" docs/design/dependencies.md
echo "kept in $table"
