#!/bin/sh
# Pictures of a world with two simulated people who play in it: `bench/world_pictures.sh WORLD [AT_S...]`, where WORLD is a name in
# deploy/demos. Films a play of that demo for 12 s without a window (out/world_WORLD/view.avi) and puts its pictures of the times given,
# 2 3 4 5 s without any, side by side into docs/figures/world_WORLD.png. The people's loops begin when their programs do: look at the film
# first, then take the times from there with FILM=no, which films nothing anew. BUILD is the build folder.
set -eu
cd "$(dirname "$0")/.."
world=$1
shift
build=${BUILD:-build}
[ $# -gt 0 ] || set -- 2 3 4 5
cmake --build "$build" --target demo site_node viewer world_server world_strip > /dev/null
if [ "${FILM:-yes}" = yes ]; then
    "$build"/bin/demo --config "deploy/demos/$world.toml" --seconds 12 --window no --output "out/world_$world"
fi
"$build"/bin/world_strip "out/world_$world/view.avi" "docs/figures/world_$world.png" 440 "$@"
ls -l "docs/figures/world_$world.png"
