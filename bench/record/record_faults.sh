#!/bin/sh
# Measures what a recorder loses to faults: kill -9 at random moments, a full disk, a disk that stands still, a clock that is set back.
# `bench/record/record_faults.sh [BUILD] [KILLS]`, 20 kills, about four minutes. Two sites of deploy/sites are recorded first; their
# recording, played in a loop, is then the world. The full disk needs a mount namespace (unshare -rm), the standing one a loop device
# (root), the clock the package faketime; what cannot be had is left out, with the reason.
# Keeps the figures in bench/results/.
set -eu
. "$(dirname "$0")/../common.sh"
kills=${2:-20}
cmake --build "$build" --target record play site_node world_server > /dev/null
exec python3 bench/record/record_faults.py --bin "$build/bin" --kills "$kills" --out "$(result record-faults).json"
