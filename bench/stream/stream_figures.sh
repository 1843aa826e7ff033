#!/bin/sh
# Draws docs/figures/stream_adaptation.svg from a run of the simulated link: `bench/stream/stream_figures.sh [BUILD]`. Configure BUILD with
# -DATRIUM_BENCH=ON. The same tree gives the same picture.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target stream_link > /dev/null
"$build"/bin/stream_link | python3 bench/stream/stream_figures.py docs/figures
