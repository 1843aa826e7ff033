#!/bin/sh
# Measures how a site on several hosts gets over faults of its hosts: sixteen cameras on four camera nodes, the model part on a fifth host,
# each in a network namespace of its own around a bridge. Kills, stops, cuts off, slows down and misdates one host after another, and
# restarts the model part. `bench/site/site_faults.sh [BUILD] [RUNS]`, 3 runs of each fault, about six minutes.
# Needs no rights but namespaces (unshare -Urn), and the package faketime. Configure BUILD with -DATRIUM_BENCH=ON.
# Keeps the figures in bench/results/ and renews the table of docs/measurements/site_hosts.md. The machine should be idle: all hosts share
# its cores. The first run renders the room.
set -eu
. "$(dirname "$0")/../common.sh"
runs=${2:-3}
cmake --build "$build" --target site_watch > /dev/null
exec python3 bench/site/site_faults.py --build "$build" --runs "$runs" --out "$(result site-faults).json"
