#!/bin/sh
# Pictures of a world with two simulated people in it: `bench/world_pictures.sh WORLD [SECONDS [BUILD]]`, where WORLD is a name in
# deploy/worlds. Runs the demo for SECONDS (10) without a window and puts four pictures side by side into docs/figures/world_WORLD.png.
set -eu
cd "$(dirname "$0")/.."
world=$1
seconds=${2:-10}
build=${3:-build}
cmake --build "$build" --target demo site_node viewer world_server world_strip > /dev/null
"$build"/bin/demo --world "deploy/worlds/$world.toml" --seconds "$seconds" --window no --output "out/world_$world"
"$build"/bin/world_strip "out/world_$world/view.avi" "docs/figures/world_$world.png" 4 480 0.5
ls -l "docs/figures/world_$world.png"
