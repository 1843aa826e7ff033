#!/bin/sh
# Draws docs/figures/stream_adaptation.svg from a run of the simulated link: `bench/stream_figures.sh [BUILD]`. Configure BUILD with
# -DATRIUM_BENCH=ON. The same tree gives the same picture.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
cmake --build "$build" --target stream_link > /dev/null
"$build"/bin/stream_link | python3 bench/stream_figures.py docs/figures
