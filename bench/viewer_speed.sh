#!/bin/sh
# How fast the viewer draws two people without a display: `bench/viewer_speed.sh [BUILD] [SECONDS of each case]`. Keeps the figures with
# machine and date in bench/results/ and renews the table of docs/viewer.md. BUILD has to be configured with -DATRIUM_BENCH=ON. Needs no
# rights; some three minutes, in which the machine should have nothing else to do. The first run renders the rooms.
set -eu
case "${1:-}" in -h | --help) exec sed -n '2,/^set/s/^# *//p' "$0" ;; esac
cd "$(dirname "$0")/.."
build=${1:-build}
seconds=${2:-20}
cmake --build "$build" --target replayed_site site_node world_server viewer > /dev/null
machine=$(lscpu | sed -n 's/^Model name: *//p')
out="bench/results/$(date +%Y-%m-%d)-$(echo "$machine" | tr -c 'A-Za-z0-9\n' '-')-viewer-speed.csv"
work=$(mktemp -d)
started=
stop() {
    [ -z "$started" ] || kill $started 2> /dev/null || true
    wait
    started=
}
trap 'stop; rm -r "$work"' EXIT
trap 'exit 130' INT TERM
mkdir -p bench/results
world=viewer-speed-$$

# starts PROGRAM ARGS..., silently
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

# row NAME ALLOWED_FPS WIDTH HEIGHT: one viewer among what was begun
row() {
    begin world_server --config deploy/worlds/demo.toml
    if ! "$build"/bin/viewer --bus.world "$world" --view.context osmesa --view.width "$3" --view.height "$4" --view.max_fps 240 --wait_people 2 \
        --wait_timeout_s 240 --seconds "$seconds" > "$work/viewer.log" 2>&1; then
        cat "$work/viewer.log"
        exit 1
    fi
    figures=$(sed -n 's/.* viewer_stopped //p' "$work/viewer.log")
    value() { echo "$figures" | tr ' ' '\n' | sed -n "s/^$1=//p"; }
    echo "\"$1\",$3,$4,$2,$(value frames_per_s),$(value taking_in_ms),$(value taking_in_p99_ms),$(value capture_to_display_ms),$(value p99_ms)" >> "$out"
    stop
}

"$build"/bin/replayed_site --stream "$work/person" --code true > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
{
    echo "# $(date -u +%Y-%m-%dT%H:%MZ), $machine, $(nproc) cores, OSMesa, $(c++ --version | head -n 1), $seconds s each"
    echo "case,width,height,allowed_fps,frames_per_s,taking_in_ms,taking_in_p99_ms,capture_to_display_ms,p99_ms"
} > "$out"
replayed
row "two people of 8 cameras come ready made" 15 1280 720
simulated
row "two simulated sites of 640x480 beside it" 10 1280 720
python3 bench/viewer_speed.py "$out" docs/viewer.md
echo "kept in $out"
