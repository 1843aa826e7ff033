#!/bin/sh
# Measures what a recorder loses to faults: kill -9 at random moments, a full disk, a disk that stands still, a clock that is set back; and
# what a room's recorder loses to kill -9. `bench/record/record_faults.sh [BUILD] [KILLS]`, 20 kills of each, about six minutes. Two sites
# of deploy/sites are recorded first; their recording, played in a loop, is then the world. The full disk needs a mount namespace
# (unshare -rm), the standing one a loop device (root), the clock the package faketime; what cannot be had is left out, with the reason.
# Keeps the figures in bench/results/ and renews the table of docs/measurements/recording.md.
set -eu
. "$(dirname "$0")/../common.sh"
kills=${2:-20}
cmake --build "$build" --target record play site_node world_server machine_score > /dev/null
figures=$(result record-faults).json
python3 bench/record/record_faults.py --bin "$build/bin" --kills "$kills" --out "$figures"
python3 bench/record/record_tables.py faults "$figures" docs/measurements/recording.md
