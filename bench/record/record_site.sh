#!/bin/sh
# Measures what recording costs a site: `bench/record/record_site.sh [BUILD] [SECONDS of each case] [FOLDER to record into]`. Keeps the
# table with machine and date in bench/results/ and renews that of docs/measurements/recording.md. Configure BUILD with -DATRIUM_BENCH=ON.
# The machine should be idle. FOLDER needs 250 MB for each second.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-20}
folder=${3:-.cache/record_site}
cmake --build "$build" --target record_site > /dev/null
mkdir -p "$folder"
table=$(result record-site.csv)
{
    echo "$(heading), $(nproc) cores, ${seconds} s each"
    "$build"/bin/record_site "$folder" "$seconds"
} > "$table"
python3 bench/record/record_tables.py site "$table" docs/measurements/recording.md
echo "kept in $table"
