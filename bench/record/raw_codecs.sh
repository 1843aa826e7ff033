#!/bin/sh
# Compares lossless codecs for the pictures of cameras: `bench/record/raw_codecs.sh [BUILD]`. Keeps the table with machine and date in
# bench/results/ and renews that of docs/measurements/recording.md. Configure BUILD with -DATRIUM_BENCH=ON. The machine should be idle. The
# first run renders the pictures.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target raw_codecs > /dev/null
table=$(result raw-codecs.csv)
{
    echo "$(heading), one thread, libavcodec $(pkg-config --modversion libavcodec)"
    "$build"/bin/raw_codecs
} > "$table"
python3 bench/record/record_tables.py codecs "$table" docs/measurements/recording.md
echo "kept in $table"
