#!/bin/sh
# Measures the speed of the viewer with two people and no display, and the cost of guests that are more demanding than people:
# `bench/viewer/viewer_speed.sh [BUILD] [SECONDS of each case]`. Keeps the figures with machine and date in bench/results/ and renews the
# tables of docs/measurements/viewer.md. Configure BUILD with -DATRIUM_BENCH=ON. Needs no rights. Takes about five minutes. The machine
# should be idle. The first run renders the rooms.
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-20}
cmake --build "$build" --target replayed_site viewer_things site_node world_server viewer > /dev/null
out=$(result viewer-speed.csv)
guests=$(result viewer-guests.csv)
work=$(mktemp -d)
started=
stop() {
    [ -z "$started" ] || kill $started 2> /dev/null || true
    wait
    started=
}
trap 'stop; rm -r "$work"' EXIT
trap 'exit 130' INT TERM
world=viewer-speed-$$

# starts PROGRAM ARGS... without output
begin() {
    program=$1
    shift
    "$build/bin/$program" --bus.world "$world" "$@" > "$work/$program.log" 2>&1 &
    started="$started $!"
}
replayed() {
    begin replayed_site --stream "$work/person" --name alice
    begin replayed_site --stream "$work/person" --name bob
}
simulated() {
    begin site_node --config deploy/sites/alice.toml
    begin site_node --config deploy/sites/bob.toml
}

# view ARGS...: runs a viewer to its end; value NAME: a figure of its report
view() {
    if ! "$build"/bin/viewer --bus.world "$world" --view.context osmesa --view.position_m 2.6,-3.6,1.9 --wait_timeout_s 240 --seconds "$seconds" "$@" \
        > "$work/viewer.log" 2>&1; then
        cat "$work/viewer.log"
        exit 1
    fi
}
value() { sed -n 's/.* viewer_stopped //p' "$work/viewer.log" | tr ' ' '\n' | sed -n "s/^$1=//p"; }

# row NAME ALLOWED_FPS WIDTH HEIGHT: one viewer beside the started programs
row() {
    begin world_server --config deploy/worlds/demo.toml
    view --view.width "$3" --view.height "$4" --view.max_fps 240 --view.adapt off --wait_people 2
    triangles=$(sed -n 's/.* person_shown .* triangles=\([0-9]*\) .*/\1/p' "$work/viewer.log" | paste -sd ' ')
    echo "\"$1\",$triangles,$3,$4,$2,$(value frames_per_s),$(value taking_in_ms),$(value taking_in_p99_ms),$(value capture_to_display_ms),$(value p99_ms)" >> "$out"
    stop
}

# guest NAME PROGRAM ARGS...: joins after a person has been shown for some pictures
guest() {
    name=$1
    guest_program=$2
    shift 2
    begin replayed_site --stream "$work/person" --name alice
    if [ "$guest_program" != none ]; then
        (sleep 4 && exec "$build/bin/$guest_program" --bus.world "$world" "$@") > "$work/guest.log" 2>&1 &
        started="$started $!"
    fi
    view --view.width 640 --view.height 360 --wait_people 1
    echo "\"$name\",$(value frames_per_s),$(value picture_ms),$(value longest_preparation_ms),$(value longest_picture_ms),$(value rejected)" >> "$guests"
    stop
}

"$build"/bin/replayed_site --stream "$work/person" --code true > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
comment="$(heading), $(nproc) cores, OSMesa, $(c++ --version | head -n 1), $seconds s each"
echo "$comment" > "$out"
echo "case,triangles,width,height,allowed_fps,frames_per_s,taking_in_ms,taking_in_p99_ms,capture_to_display_ms,p99_ms" >> "$out"
replayed
row "two people of 8 cameras come ready made" 30 1280 720
simulated
row "two simulated sites of 640x480 beside it" 10 1280 720
echo "$comment" > "$guests"
echo "guest,frames_per_s,picture_ms,longest_preparation_ms,longest_picture_ms,rejected" >> "$guests"
guest "nobody" none
guest "a thousand things that come, move, and go, every 3 s" viewer_things
guest "likewise, of any size, anywhere, at 100 km/s" viewer_things --absurd true
guest "a site of 64 cameras" replayed_site --stream "$work/person" --name eve --cameras 64
guest "a site of 64 cameras and 44,000 triangles" replayed_site --stream "$work/person" --name eve --cameras 64 --subdivide 1
guest "cameras and meshes that nothing real is like" replayed_site --stream "$work/person" --name eve --absurd true
python3 bench/viewer/viewer_speed.py "$out" "$guests" docs/measurements/viewer.md
echo "kept in $out and $guests"
