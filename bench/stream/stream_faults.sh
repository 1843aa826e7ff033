#!/bin/sh
# Measures a site and a viewer over links with faults: `bench/stream/stream_faults.sh [BUILD] [SECONDS of each case]`. Keeps the figures
# with machine and date in bench/results/ and renews the table of docs/measurements/streams.md. Configure BUILD with -DATRIUM_BENCH=ON.
# Needs /dev/net/tun, but no rights. Takes about five minutes. The machine should be idle.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-15}
cmake --build "$build" --target stream_faults > /dev/null
out=$(result stream-faults.csv)
echo "$(heading), $(nproc) cores, $(c++ --version | head -n 1), ${seconds} s each" > "$out"
"$build"/bin/stream_faults "$seconds" >> "$out"
python3 bench/stream/stream_faults.py "$out" docs/measurements/streams.md
