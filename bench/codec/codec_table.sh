#!/bin/sh
# Measures the coded size of a frame: `bench/codec/codec_table.sh [BUILD]`. Keeps the table with machine and date in bench/results/ and
# renews the table of docs/measurements/codecs.md. Configure BUILD with -DATRIUM_BENCH=ON. The machine should be idle. Skips the recording
# if ../shared/data is missing.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target codec_table > /dev/null
table=$(result codec.csv)
{
    echo "$(heading), one thread, $(c++ --version | head -n 1)"
    "$build"/bin/codec_table
} > "$table"
python3 bench/codec/codec_table.py "$table" docs/measurements/codecs.md
echo "kept in $table"
