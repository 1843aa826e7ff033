#!/bin/sh
# Floods a closed world from outside and measures what its members lose: `bench/security/floods.sh [BUILD] [SECONDS of each flood]`. Keeps
# the figures in bench/results/, and renews the table of docs/measurements/security.md. Needs root, to listen on the network.
set -eu
. "$(dirname "$0")/../common.sh"
cmake --build "$build" --target keys security_attacker security_flood site_node stream_watch world_server machine_score > /dev/null
python3 bench/security/floods.py "$build" "${2:-60}"
