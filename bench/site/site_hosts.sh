#!/bin/sh
# Measures a site on several hosts against the same site as one process: sixteen cameras of 640x480 at 30/s, four on each of four camera
# nodes, the model part, a world server and a viewer, each in a network namespace of its own around a bridge.
# `bench/site/site_hosts.sh [BUILD] [SECONDS] [RUNS]`, 20 s and 3 runs of each, interleaved. Needs no rights but namespaces (unshare -Urn).
# Keeps the figures in bench/results/ and renews the table of docs/measurements/site_hosts.md. The machine should be idle: all hosts share
# its cores. The first run renders the room.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-20}
runs=${3:-3}
exec python3 bench/site/site_hosts.py --build "$build" --seconds "$seconds" --runs "$runs" --out "$(result site-hosts).json"
