#!/bin/sh
# Measures the whole site on two cores: `bench/site/site_8x1mp.sh [BUILD] [SECONDS of each case]`. Keeps text and table with machine and
# date in bench/results/ and renews the table of docs/measurements/site.md. Configure BUILD with -DATRIUM_BENCH=ON.
# The machine should be idle. The first run renders the pictures.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-8}
cmake --build "$build" --target site_8x1mp > /dev/null
out=$(result site-8x1mp)
comment="$(heading), $(nproc) cores, $(c++ --version | head -n 1), niceness $(nice), ${seconds} s each"
echo "$comment" > "$out.csv"
{ echo "$comment"; "$build"/bin/site_8x1mp "$seconds" "$out.csv"; } | tee "$out.txt"
python3 bench/site/site_8x1mp.py "$out.csv" docs/measurements/site.md
echo "kept in $out.csv and $out.txt"
