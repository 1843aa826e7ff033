#!/bin/sh
# Measures what a segmentation worker costs a site, and how long the example worker takes: `bench/site/worker_bench.sh [BUILD]`. Keeps the
# table with machine and date in bench/results/. Configure BUILD with -DATRIUM_BENCH=ON. The machine should be idle. Takes two minutes.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target worker_bench > /dev/null
folder=$(mktemp -d)
/usr/bin/python3 tools/segmentation_worker/opencv_worker.py "$folder/socket" > "$folder/log" 2>&1 &
worker=$!
trap 'kill "$worker" 2> /dev/null || true; rm -rf "$folder"' EXIT
table=$(result segmentation-worker.csv)
{
    heading
    ATRIUM_WORKER=$folder/socket "$build"/bin/worker_bench --benchmark_repetitions=5 --benchmark_min_time=2 \
        --benchmark_report_aggregates_only=true --benchmark_format=csv 2> "$folder/errors"
} > "$table" || { cat "$folder/log" "$folder/errors" >&2; rm -f "$table"; exit 1; }
echo "kept in $table"
