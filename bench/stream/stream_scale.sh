#!/bin/sh
# Measures sites and subscribers on one host: `bench/stream/stream_scale.sh [BUILD] [SECONDS of each case, but 60 for 16 subscribers on
# loopback]`. Keeps the figures with machine and date in bench/results/, renews the tables of docs/measurements/streams.md and draws
# docs/figures/stream_scale.svg. Configure BUILD with -DATRIUM_BENCH=ON. Needs no rights. Takes about fifteen minutes. The machine should be
# idle. ONLY=name measures one series (loopback, decode, multicast, lan, crowd) and adds it to the file of this day. RUN is put before each
# measurement (RUN="nice -n -5").
set -eu
. "$(dirname "$0")/../common.sh"
seconds=${2:-12}
only=${ONLY:-}
run=${RUN:-}
cmake --build "$build" --target stream_scale stream_crowd > /dev/null
scale=$(result stream-scale.csv)
crowd=$(result stream-crowd.csv)
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
"$build"/bin/replayed_site --stream "$work/person" --code true > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }

# new FILE PROGRAM: starts a file of this day
new() {
    [ -n "$only" ] && [ -e "$1" ] && return 0
    {
        echo "$(heading), $(nproc) cores, $(c++ --version | head -n 1)"
        "$build"/bin/"$2" head
    } > "$1"
}
wants() { [ -z "$only" ] || [ "$only" = "$1" ]; }

# row NAME NETWORK SUBSCRIBERS DECODE: fails if the programs do not find each other in time
row() {
    length=$seconds
    case $1-$3 in loopback-16 | decode-16) length=60 ;; esac
    $run "$build"/bin/stream_scale "$1" "$2" "$work/person" 4 "$3" "$4" "$length" >> "$scale" 2> "$work/log" && return 0
    tail -c 500 "$work/log"
    echo "$1, $3 subscribers: no result"
    return 1
}

# the same files with one change: data by multicast as well, over lo
multicast() { sed -e 's/<AllowMulticast>[a-z]*</<AllowMulticast>true</' -e 's/multicast="false"/multicast="true"/' "$1"; }
on_lo() { sed -e 's|<General>|<General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces>|' "$1"; }
multicast qos/loopback.xml > "$work/multicast.xml"
on_lo qos/lan.xml > "$work/lan.xml"
multicast "$work/lan.xml" > "$work/lan-multicast.xml"

new "$scale" stream_scale
new "$crowd" stream_crowd
if wants loopback; then for n in 0 1 2 4 8 16 32 48; do row loopback loopback $n false || break; done; fi
if wants decode; then for n in 1 2 4 8 16; do row decode loopback $n true || break; done; fi
if wants multicast; then for n in 1 2 4 8 16 32 48; do row multicast "$work/multicast.xml" $n false || break; done; fi
if wants lan; then for n in 4 16; do
    row lan "$work/lan.xml" $n false
    row lan-multicast "$work/lan-multicast.xml" $n false
done; fi
if wants crowd; then for n in 10 20 40 60 80 100; do
    $run "$build"/bin/stream_crowd idle crowd_member loopback $n 10 "$seconds" >> "$crowd" || break
done; fi
python3 bench/stream/stream_scale.py "$scale" "$crowd" docs/measurements/streams.md docs/figures
