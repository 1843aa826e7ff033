#!/bin/sh
# Measures the masks beside OpenCV's: `bench/site/segmentation_quality.sh [BUILD]`. Keeps the table with machine and date in
# bench/results/ and renews that of docs/measurements/segmentation.md. Configure BUILD with -DATRIUM_BENCH=ON. The machine
# should be idle. Skips missing recordings. `bench/site/segmentation_quality.sh BUILD --ours-only` measures without OpenCV's,
# in a minute, and renews the table of outlines.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target segmentation_quality > /dev/null
only=${2:-}
name=quality
[ -z "$only" ] || name=outlines
table=$(result "segmentation-$name.csv")
{
    echo "$(heading), one thread, $(c++ --version | head -n 1)"
    "$build"/bin/segmentation_quality $only
} > "$table"
python3 bench/site/segmentation_table.py "$table" docs/measurements/segmentation.md "$name"
echo "kept in $table"
