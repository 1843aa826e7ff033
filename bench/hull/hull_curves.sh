#!/bin/sh
# Measures the hull: `bench/hull/hull_curves.sh [BUILD] [REPETITIONS]`. Keeps tables with machine and date in bench/results/,
# draws docs/figures/hull_curves.svg, prints all tables and renews those of docs/measurements/hull.md. Configure BUILD with
# -DATRIUM_BENCH=ON. The machine should be idle. Skips everything that needs ../shared/data if it is missing.
set -eu
. "$(dirname "$0")/../common.sh"
repetitions=${2:-20}
cmake --build "$build" --target hull_curves hull_memory > /dev/null
prefix=$(result hull)
comment="$(heading), $(nproc) cores, $(c++ --version | head -n 1), least of $repetitions"
for table in segments views threads sets masks; do
    echo "measuring: $table"
    { echo "$comment"; "$build"/bin/hull_curves "$table" "$repetitions"; } > "$prefix-$table.csv"
done
{ echo "$comment"; "$build"/bin/hull_memory; } > "$prefix-memory.csv"
python3 bench/hull/hull_curves.py "$prefix" docs/figures/hull_curves.svg docs/measurements/hull.md
echo "kept in $prefix-*.csv"
