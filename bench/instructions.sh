#!/bin/sh
# Counts the instructions per metaframe of site, world server and viewer: `bench/instructions.sh --help`.
exec python3 "$(dirname "$0")/instructions.py" "$@"
