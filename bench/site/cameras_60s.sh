#!/bin/sh
# Runs eight simulated GigE Vision cameras of one megapixel at 20 Hz through Aravis into hulls for a minute. One camera is away for ten
# seconds, one loses 1 % of its packets, one restarts. Prints the result of every trigger. Exits with 1 if a check fails.
# tests/integration/cameras_test is a short version.
#   bench/site/cameras_60s.sh [BUILD_FOLDER]
set -eu
. "$(dirname "$0")/../common.sh"
rig=deploy/rigs/full_body_1mp.toml
cmake --build "$build" --target simulated_cameras cameras_client
# times count from the first picture; learning the background takes the first two to five seconds
exec "$build/bin/simulated_cameras" --log-level warn --rig "$rig" --rate_hz 20 --stamp --empty_seconds 8 --simulation.loop_s 1 \
    --lose cam3=1 --stop cam2@20+10 --restart cam5@45 -- \
    "$build/bin/cameras_client" --log-level warn --rig "$rig" --seconds 60 --outages cam2=10,cam5=0 --lossy cam3
