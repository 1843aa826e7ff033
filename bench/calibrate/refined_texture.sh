#!/bin/sh
# Whether people look better with a rig that `calibrate refine` mended: `bench/calibrate/refined_texture.sh [BUILD]`. Refines the shared
# recording ring20 from its own silhouettes and compares drawn people with the pictures of cameras that gave no textures, before and after
# (bench/viewer/texture_quality). Keeps the figures with machine and date in bench/results/ and renews docs/measurements/calibration.md.
# Configure BUILD with -DATRIUM_BENCH=ON. Needs ../shared/data. Takes a minute.
set -eu
. "$(dirname "$0")/../common.sh"
ring=$(cd ../shared/data/recordings/ring20 && pwd)
cmake --build "$build" --target texture_quality calibrate > /dev/null
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
refined=$scratch/ring20
mkdir "$refined"
for entry in "$ring"/*; do ln -s "$entry" "$refined/"; done
rm "$refined/rig.toml"
"$build"/bin/calibrate refine "$ring/rig.toml" --recording "$ring" --force -o "$refined/rig.toml" > "$scratch/log" || {
    cat "$scratch/log"
    exit 1
}
before=$(result refined-texture-before.csv)
after=$(result refined-texture-after.csv)
{
    heading
    "$build"/bin/texture_quality --only ring20 --recording "$ring"
} > "$before"
{
    heading
    "$build"/bin/texture_quality --only ring20 --recording "$refined"
} > "$after"
python3 bench/calibrate/refined_texture.py "$before" "$after" docs/measurements/calibration.md
echo "kept in $before and $after"
