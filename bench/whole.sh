#!/bin/sh
# Compares the demos of two commits, interleaved: `bench/whole.sh --help`.
exec python3 "$(dirname "$0")/whole.py" "$@"
