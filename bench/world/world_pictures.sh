#!/bin/sh
# Makes pictures of a world with two simulated people who play in it: `bench/world/world_pictures.sh WORLD [AT_S...]`, where WORLD is a name
# in deploy/demos. Films that demo for 12 s without a window (out/world_WORLD/view.avi) and puts its pictures at the given times (default 2
# 3 4 5 s) side by side into docs/figures/world_WORLD.png. The people's loops start with their programs. Watch the film first, then choose
# the times with FILM=no, which uses the existing film. BUILD is the build folder.
set -eu
. "$(dirname "$0")/../common.sh"
build=${BUILD:-build}
world=$1
shift
[ $# -gt 0 ] || set -- 2 3 4 5
cmake --build "$build" --target demo site_node viewer world_server world_strip > /dev/null
if [ "${FILM:-yes}" = yes ]; then
    "$build"/bin/demo --config "deploy/demos/$world.toml" --seconds 12 --window no --output "out/world_$world"
fi
"$build"/bin/world_strip "out/world_$world/view.avi" "docs/figures/world_$world.png" 440 "$@"
ls -l "docs/figures/world_$world.png"
