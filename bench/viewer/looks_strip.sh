#!/bin/sh
# Draws the strip of pictures of docs/design/refinement.md: `bench/viewer/looks_strip.sh [BUILD] [VIEW]`. For each person of the simulated
# room: the true person; as the viewer shows the hull alone; with `hull.refine = "round_photo"` and soft outlines. VIEW is one of the
# 20 free viewpoints of texture_quality. Configure BUILD with -DATRIUM_BENCH=ON. Needs no display, but OpenCV for Python. Takes about three
# minutes.
set -eu
. "$(dirname "$0")/../common.sh"
view=${2:-3}
cmake --build "$build" --target texture_quality > /dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for look in ada ben mira otto; do
    for refine in off round_photo; do
        soft=$([ $refine = off ] && echo false || echo true)
        "$build"/bin/texture_quality --only room --orbit-steps 0 --look $look --refine $refine --soft-outlines "$soft" \
            --log-level warn --pictures "$folder/$look-$refine" > /dev/null 2>> "$folder/log" || { cat "$folder/log" >&2; exit 1; }
    done
done
python3 bench/viewer/looks_strip.py "$folder" "$view" docs/figures/looks_strip.png
